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

/// Plans a page: an HTML file that shows a recording (docs/replay.md). A frame is the recorded state of the
/// world at one time. An array of a recording has the values of one field of the state, such as the readings
/// of a sensor, in all frames. Fields belong to components, such as "pose". A page has one row for each
/// recorded body (RecordingReader::ids()).
namespace troupe::worldio {

/// Consecutive rows of a page: first, ..., first + count - 1.
struct ReplayRun {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/// An array that a page shows in addition to poses. The page rounds each value to min + k * step, where k is
/// a whole number from 0 to `steps`. `min`, `max` and `step` have the unit of the array. If no value is
/// finite in any frame, `min`, `max` and `steps` are 0.
struct ReplayField {
  const RecordingReader::Array* array = nullptr;
  std::vector<std::uint32_t> rows;  ///< rows of `array` whose bodies have the field, in the order of the page
  std::vector<ReplayRun> runs;      ///< rows of the page whose bodies have the field
  /// Smallest finite value in all frames, rounded down to a multiple of `step`. It is not rounded if all
  /// finite values are equal.
  double min = 0;
  double max = 0;           ///< largest finite value in all frames, not rounded
  double step = 1;          ///< difference of neighbouring rounded values
  std::uint32_t steps = 0;  ///< largest value of k in min + k * step
};

/// What a page shows of a recording, and in which order.
struct ReplayPlan {
  RecordedScene scene;  ///< shapes, names and colours of the bodies
  /// For each row of the page, its index in RecordingReader::ids(); sorted by type, then by id.
  std::vector<std::uint32_t> order;
  /// The arrays of x, y, heading and z, in this order. The array of z is null if no body changes its height
  /// in any frame, or if heights were not recorded.
  std::array<const RecordingReader::Array*, 4> pose{};
  std::vector<double> heights;      ///< the height of each row of the page, m; used if the array of z is null
  Box bounds;                       ///< box around all bodies in all frames, world frame, m
  std::vector<ReplayField> fields;  ///< the arrays that the page shows in addition to poses
  bool at_rest = false;             ///< whether robots have joints whose displacements were not recorded
};

/// Reads the values of arrays as doubles. The recording must outlive this object. If the frames of an array
/// are read one after the other, each access to the file reads many frames.
class FrameReader {
 public:
  explicit FrameReader(const RecordingReader& recording) : recording_(recording) {}
  /// Resizes `into` and fills it with the values of an array in one frame, in row-major order. `frame` is the
  /// index of the frame. All values of a body that is absent in the frame are NaN. A body that does not have
  /// the component of the array (RecordingReader::has()) has NaN, or 0 if the array has integers. A number of
  /// type f64 above 1e150 in absolute value is replaced by NaN.
  void read(const RecordingReader::Array& array, std::size_t frame, std::vector<double>& into);

 private:
  void load(const RecordingReader::Array& array, std::size_t frame);

  const RecordingReader& recording_;
  // bytes_ holds `count_` frames of `array_`, from `first_` on, and alive_ the same frames.
  const RecordingReader::Array* array_ = nullptr;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  std::vector<std::byte> bytes_;
  std::vector<std::uint8_t> alive_;
};

/// Plans a page. Reads all frames to find the smallest and the largest value of each field.
///
/// Each entry of `fields` is "all", a component ("stall"), a field of any component ("ranges"), or a field of
/// one component ("stall.stalled"). If `fields` is empty, the page shows all recorded fields. The page always
/// shows the displacements of joints and the colours that devices such as LEDs set.
///
/// Throws InputError if the recording has no poses, no complete frame or no recorded body, or if an entry of
/// `fields` selects nothing recorded. Throws Hdf5Error if the recording cannot be read. The plan points to
/// arrays of the recording, which must outlive the plan.
ReplayPlan plan_replay(const RecordingReader& recording, std::span<const std::string> fields);

}  // namespace troupe::worldio
