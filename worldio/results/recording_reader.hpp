#pragma once

#include "engine/fields/state_table.hpp"
#include "worldio/json/spec_json.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// Reads a recording (docs/recordings.md): an HDF5 file with the state of a world at certain ticks
/// (time steps). The state at one of these ticks is called a frame.
///
/// The state consists of components, such as "pose" or the readings of a sensor. A component consists of
/// fields, such as "x". A recording has one array for each field. In each frame, an array has one row per
/// body, and a row has one or more columns.
///
/// The recording may be closed, still being written, or cut off because its writer was killed. On failure,
/// all functions throw Hdf5Error with the name of the file.
class RecordingReader {
 public:
  /// Opens a recording and reads its attributes, the recorded bodies and the list of frames. Frames that a
  /// running writer adds later are not seen.
  explicit RecordingReader(const std::filesystem::path& file);

  /// Returns the group /meta of an HDF5 file. Throws if the file is not a recording, or if this program
  /// cannot read the layout (the version of the file structure) of the recording.
  static Hdf5Group checked_meta(const Hdf5File& file);

  const std::filesystem::path& file() const { return hdf5_.file_name(); }
  /// Whether the recording was not closed: its writer is still running or was killed. If the writer was
  /// killed, `troupe repair` makes the file readable for ordinary HDF5 tools.
  bool unfinished() const { return unfinished_; }
  /// The attributes of /meta, such as "version", "world" and "seed", with their values as texts.
  const std::map<std::string, std::string>& meta() const { return meta_; }
  /// The number of ticks from one frame to the next.
  std::uint64_t every_ticks() const { return every_ticks_; }
  /// Reads /world: the spec of the world (the description from which the engine built it), in the JSON format
  /// of spec_to_json().
  std::string world_json() const { return hdf5_.read_text("world"); }

  /// The recorded bodies, one for each row of /state, in the order of their ids. ids() has the BodyIds
  /// (numbers in the world) of these bodies, types() the names that their types have in the recording, and
  /// names() their own names. A type describes bodies of the same construction.
  std::span<const std::uint32_t> ids() const { return ids_; }
  std::span<const std::string> types() const { return types_; }
  std::span<const std::string> names() const { return names_; }

  /// Returns the group /scene: all bodies of the world as it was loaded, walls included. Of the columns, only
  /// `word`, `number`, `type`, `pose` and `color` are filled. Returns std::nullopt if the recording is so old
  /// that it has no such group.
  std::optional<BodyColumns> scene() const;

  /// The number of complete frames, and for each of them the tick, the simulated time and the state hash.
  /// Ticks increase from frame to frame. Times are finite and do not decrease.
  std::size_t frames() const { return ticks_.size(); }
  std::span<const std::uint64_t> ticks() const { return ticks_; }
  std::span<const double> times_s() const { return times_s_; }
  std::span<const std::uint64_t> hashes() const { return hashes_; }

  /// An array of the recording: the values of one field in all frames.
  struct Array {
    std::string component;     ///< name of the component, such as "pose" or "sensors/minibot/ranger:0"
    engine::StateField field;  ///< name, element type, number of columns, unit and meaning
    std::string frame;  ///< coordinate frame of the values, such as "world", "body" or "sensor"; empty: none
    std::vector<std::uint32_t> bodies;  ///< for each row, the index of its body in ids()
    Hdf5Dataset dataset;                ///< the values: frames x rows x columns
    std::size_t row_bytes() const { return field.bytes(); }
  };
  /// All arrays, in the order in which a tick computes them: sensors, memories of controllers, velocities,
  /// poses.
  std::span<const Array> arrays() const { return arrays_; }
  /// Returns, for each row of an array, 1 if the body of the row has Array::component, else 0. A row with 0
  /// holds no recorded values: all its values are NaN, or 0 if the array has integers.
  std::vector<std::uint8_t> has(const Array& array) const;
  /// Returns, for each of `count` frames and each body in ids(), 1 if it is in the world in the frame, else
  /// 0. The values of a frame are consecutive. `frame` is the index of the first frame, and frame + count
  /// must be at most frames(). If the recording has no array /state/alive, all entries are 1.
  std::vector<std::uint8_t> alive(std::size_t frame, std::size_t count = 1) const;
  /// Reads the values of an array in one or more frames, in row-major order. `frame` is the index of the
  /// first frame. `into` must have array.row_bytes() bytes for each frame and each row of the array, and so
  /// many frames must exist.
  void read(const Array& array, std::size_t frame, std::span<std::byte> into) const;

 private:
  void find_arrays(const Hdf5Group& group, const std::filesystem::path& place,
                   const std::vector<std::uint32_t>& bodies);
  void read_frames();

  bool unfinished_;
  Hdf5File hdf5_;
  std::map<std::string, std::string> meta_;
  std::uint64_t every_ticks_ = 1;
  std::vector<std::uint32_t> ids_;
  std::vector<std::string> types_;
  std::vector<std::string> names_;
  std::vector<std::uint64_t> ticks_;
  std::vector<double> times_s_;
  std::vector<std::uint64_t> hashes_;
  std::vector<Array> arrays_;
  std::optional<Hdf5Dataset> alive_;
};

/// Whether a name selects the component of an array. For the component `sensors/minibot/lamp`, such a name is
/// - the name of the component, or its part before the first slash (`sensors`),
/// - the name of the device or joint in the world file (`lamp`),
/// - the name of the body type and of the device (`minibot/lamp`), or
/// - the kind (sort) and the name of the device (`led/lamp`). Recordings do not store kinds: the kind may be
///   any word that is not the name of a recorded type.
///
/// The first two rules are those of engine::selects(). They also apply to components that do not belong to a
/// device.
bool selects(std::string_view name, const RecordingReader::Array& array, const RecordingReader& recording);
/// Converts a name of a component or field from the spelling of earlier versions of Troupe to the present
/// spelling. Earlier versions used the path of a sensor, or a slash before the field. For example,
/// "sensors/minibot/eye" becomes "eye"; "sensors/minibot/eye.ranges" and "eye/ranges" become "eye.ranges". If
/// devices of several types have the name "eye", the result contains the type: "minibot/eye.ranges". Returns
/// std::nullopt if `name` is not in an earlier spelling, or if the recording has no such component or field.
std::optional<std::string> present_name(std::string_view name, const RecordingReader& recording);
/// Returns the name under which user interfaces show a component. A component of /sensors is shown as the
/// name of the device, followed by the type: `lamp (minibot)` for `sensors/minibot/lamp`. A component of
/// /state is shown without its kind: `arm` for `joint/arm`, `pose` for `pose` (engine::given_name()).
/// Characters that hdf5_name() replaced are restored: `x/y (minibot)` for `sensors/minibot/x%2Fy`.
std::string shown_name(std::string_view component);

}  // namespace troupe::worldio
