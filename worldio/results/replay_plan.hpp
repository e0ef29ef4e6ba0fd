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

/// Consecutive rows of a page: first, ..., first + count - 1. A page is an HTML file that shows a recording
/// (docs/replay.md). It has one row per recorded body.
struct ReplayRun {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/// An array of the state that a page shows in addition to poses. Its values are rounded to min + k * step,
/// with whole numbers k from 0 to `steps`.
struct ReplayField {
  const RecordingReader::Array* array = nullptr;
  std::vector<std::uint32_t> rows;  ///< rows of the array, in the order of the page
  std::vector<ReplayRun> runs;      ///< rows of the page that have the field
  double min = 0;           ///< smallest finite number in all frames, rounded down to a multiple of `step`
  double max = 0;           ///< largest finite number in all frames
  double step = 1;          ///< difference of neighbouring rounded values
  std::uint32_t steps = 0;  ///< the largest k
};

/// What a page shows of a recording, and in which order.
struct ReplayPlan {
  RecordedScene scene;
  std::vector<std::uint32_t>
      order;  ///< for each row of the page, its row in the recording; sorted by type, then by id
  /// The arrays of x, y, heading and z. The last is null if no body ever changes its height, or if heights
  /// were not recorded.
  std::array<const RecordingReader::Array*, 4> pose{};
  std::vector<double> heights;  ///< if z is null: the height of each row of the page, m
  Box bounds;                   ///< box around everything that is visible in any frame, m
  std::vector<ReplayField> fields;
  bool at_rest = false;  ///< whether there are moving parts whose poses were not recorded
};

/// Reads frames of arrays as numbers. read() resizes `into` and fills it in row-major order. A number is NaN
/// if the body has no value or is absent in the frame, and if a double is larger than 1e150 in absolute
/// value.
class FrameReader {
 public:
  explicit FrameReader(const RecordingReader& recording)
      : recording_(recording), alive_frame_(recording.frames()) {}
  void read(const RecordingReader::Array& array, std::size_t frame, std::vector<double>& into);

 private:
  const RecordingReader& recording_;
  std::vector<std::byte> bytes_;
  std::vector<std::uint8_t> alive_;
  std::size_t alive_frame_;  // the frame that alive_ is from; recording_.frames() if there is none yet
};

/// Plans a page. Reads every frame once to find the ranges of the numbers. Each entry of `fields` names a
/// component ("stall"), a field of any component ("ranges") or a field of one component ("stall/stalled"); if
/// `fields` is empty, the page shows all recorded fields. The poses of joints and the shown colours are
/// always included. Throws InputError if the recording has no poses, frames or bodies, or if nothing recorded
/// has a name in `fields`. Throws Hdf5Error if it cannot be read.
ReplayPlan plan_replay(const RecordingReader& recording, std::span<const std::string> fields);

}  // namespace troupe::worldio
