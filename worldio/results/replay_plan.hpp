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
/// (docs/replay.md). It has one row for each recorded body (RecordingReader::ids()). An array of a recording
/// has the values of one field of the state, such as the readings of a sensor, for all frames (recorded
/// times). Fields belong to components, such as "pose".
struct ReplayRun {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/// An array of the state that a page shows in addition to poses. A page rounds its values to min + k * step,
/// with whole numbers k from 0 to `steps`. `min`, `max` and `step` have the unit of the array. If the array
/// has no finite number in any frame, `min`, `max` and `steps` are 0.
struct ReplayField {
  const RecordingReader::Array* array = nullptr;
  std::vector<std::uint32_t> rows;  ///< rows of `array` whose bodies have the field, in the order of the page
  std::vector<ReplayRun> runs;      ///< rows of the page whose bodies have the field
  /// Smallest finite number in all frames, rounded down to a multiple of `step`. It is not rounded if all
  /// finite numbers are equal.
  double min = 0;
  double max = 0;           ///< largest finite number in all frames, not rounded
  double step = 1;          ///< difference of neighbouring rounded values
  std::uint32_t steps = 0;  ///< largest value of k in min + k * step
};

/// What a page shows of a recording, and in which order.
struct ReplayPlan {
  RecordedScene scene;  ///< shapes, names and colours of the bodies
  std::vector<std::uint32_t>
      order;  ///< for each row of the page, its row in the recording; sorted by type, then by id
  /// The arrays of x, y, heading and z. The last is null if no body ever changes its height, or if heights
  /// were not recorded.
  std::array<const RecordingReader::Array*, 4> pose{};
  std::vector<double> heights;      ///< the height of each row of the page, m; used if the array of z is null
  Box bounds;                       ///< box around everything that is visible in any frame, m
  std::vector<ReplayField> fields;  ///< the arrays that the page shows in addition to poses
  bool at_rest = false;             ///< whether robots have joints whose displacements were not recorded
};

/// Reads frames of arrays as doubles. read() resizes `into` and fills it with the numbers of one frame in
/// row-major order. All numbers of a body that is absent in the frame are NaN. Numbers of type f64 above
/// 1e150 in absolute value become NaN. A body that lacks the component of the array (RecordingReader::has())
/// has NaN, or 0 if the array has integers. The recording must outlive this object.
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

/// Plans a page. Reads all frames to find the ranges of the numbers. Each entry of `fields` is "all", or
/// names a component ("stall"), a field of any component ("ranges") or a field of one component
/// ("stall.stalled"); if `fields` is empty, the page shows all recorded fields. The displacements of joints
/// and the colours that bodies show in the run, such as those of LEDs, are always included. Throws InputError
/// if the recording has no poses, no complete frame or no recorded body, or if an entry of `fields` selects
/// nothing recorded. Throws Hdf5Error if the recording cannot be read. The plan points to arrays of the
/// recording, which must outlive it.
ReplayPlan plan_replay(const RecordingReader& recording, std::span<const std::string> fields);

}  // namespace troupe::worldio
