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

/// An array of the state that a page shows in addition to poses. Values are min + k * step, for integers k.
struct ReplayField {
  const RecordingReader::Array* array = nullptr;
  std::vector<std::uint32_t> rows;  ///< rows of the array, in the order of the page
  std::vector<ReplayRun> runs;      ///< rows of the page that have it
  double min = 0;                   ///< over the finite numbers of all frames
  double max = 0;
  double step = 1;
  std::uint32_t steps = 0;  ///< the largest k
};

/// What a page shows of a recording, and in which order.
struct ReplayPlan {
  RecordedScene scene;
  std::vector<std::uint32_t> order;  ///< row of the page -> row of the recording: by type, then by id
  /// x, y, heading and z; z is null if no robot ever changes its height.
  std::array<const RecordingReader::Array*, 4> pose{};
  std::vector<double> heights;  ///< by row of the page, m, if z is null
  Box bounds;                   ///< of everything that is visible in any frame, m
  std::vector<ReplayField> fields;
  bool at_rest = false;  ///< there are parts that move whose poses were not recorded
};

/// Reads one frame of an array as numbers, row-major, and resizes `into`. NaN: no value, or the body is
/// absent.
class FrameReader {
 public:
  explicit FrameReader(const RecordingReader& recording)
      : recording_(recording), alive_frame_(recording.frames()) {}
  void read(const RecordingReader::Array& array, std::size_t frame, std::vector<double>& into);

 private:
  const RecordingReader& recording_;
  std::vector<std::byte> bytes_;
  std::vector<std::uint8_t> alive_;
  std::size_t alive_frame_;  // the frame of alive_
};

/// Plans a page, for which it reads every frame once to find the range of the numbers. `fields`: components
/// ("stall"), fields ("ranges") or both ("stall/stalled"); empty: all that were recorded. Joints and shown
/// colours are always included. Throws InputError if there are no poses, no frames, or no such field; and
/// Hdf5Error.
ReplayPlan plan_replay(const RecordingReader& recording, std::span<const std::string> fields);

}  // namespace troupe::worldio
