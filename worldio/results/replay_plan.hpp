#pragma once

#include "base/geometry.hpp"
#include "worldio/results/recorded_scene.hpp"
#include "worldio/results/recording_reader.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace troupe::worldio {

/// Rows [first, first + count) of a page.
struct ReplayRun {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/// An array of the state that a page shows beside poses, as whole numbers: min + k * step.
struct ReplayField {
  const RecordingReader::Array* array = nullptr;
  std::vector<std::uint32_t> rows;  ///< of the array, in the order of the page
  std::vector<ReplayRun> runs;      ///< of the page, that have it
  double min = 0;                   ///< of the numbers that are finite, in all frames
  double max = 0;
  double step = 1;
  std::uint32_t steps = 0;  ///< the largest k
};

/// What of a recording a page shows, and in which order.
struct ReplayPlan {
  RecordedScene scene;
  std::vector<std::uint32_t> order;  ///< row of the page -> row of the recording: by type, then by id
  /// x, y, heading and z; z is null where no robot ever leaves its height.
  std::array<const RecordingReader::Array*, 4> pose{};
  std::vector<double> heights;  ///< by row of the page, m, where z is null
  Box bounds;                   ///< of all that is ever seen, m
  std::vector<ReplayField> fields;
  bool at_rest = false;  ///< there are parts that move, whose poses were not recorded
};

/// One frame of an array as numbers, row-major; `into` is resized to it. NaN: none, also of whom is not
/// there.
class FrameReader {
 public:
  explicit FrameReader(const RecordingReader& recording)
      : recording_(recording), alive_frame_(recording.frames()) {}
  void read(const RecordingReader::Array& array, std::size_t frame, std::vector<double>& into);

 private:
  const RecordingReader& recording_;
  std::vector<std::byte> bytes_;
  std::vector<std::uint8_t> alive_;
  std::size_t alive_frame_;  // that alive_ is of
};

/// Reads every frame once, for what the numbers span. `fields`: components ("stall"), fields ("ranges") or
/// both ("stall/stalled"); empty: all that was recorded. Joints and shown colours are always among them.
/// Throws InputError: no poses, no frame, a field that was not recorded; and Hdf5Error.
ReplayPlan plan_replay(const RecordingReader& recording, std::span<const std::string> fields);

}  // namespace troupe::worldio
