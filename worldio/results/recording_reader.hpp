#pragma once

#include "engine/fields/state_table.hpp"
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

/// Reads a recording (docs/recordings.md) frame by frame. A recording is an HDF5 file. A frame is the state
/// of the world at a recorded tick (simulation step). The state consists of components, such as "pose" or the
/// readings of a sensor. A component has one row per body and one or more fields, each of which is an array.
/// The recording may be closed, still being written, or cut off because its writer was killed. On failure,
/// all functions throw Hdf5Error with the name of the file.
class RecordingReader {
 public:
  /// Opens a recording and reads everything except the values of the arrays. Frames that a running writer
  /// adds later are not seen.
  explicit RecordingReader(const std::filesystem::path& file);

  /// Returns the group /meta of an HDF5 file. Throws if the file is not a recording or has another layout.
  static Hdf5Group checked_meta(const Hdf5File& file);

  const std::filesystem::path& file() const { return hdf5_.file_name(); }
  /// Whether the recording was not closed: its writer is still running or was killed. If the writer was
  /// killed, `troupe repair` makes the file readable for ordinary HDF5 tools.
  bool unfinished() const { return unfinished_; }
  /// The attributes of /meta, as texts.
  const std::map<std::string, std::string>& meta() const { return meta_; }
  /// The number of ticks from one frame to the next.
  std::uint64_t every_ticks() const { return every_ticks_; }
  /// Reads /world: the spec of the world (the description from which the engine built it) as JSON, from
  /// spec_to_json().
  std::string world_json() const { return hdf5_.read_text("world"); }

  /// The recorded bodies, one for each row of /state, in the order of their ids. ids() are their BodyIds
  /// (numbers in the world), types() the names of their types in the recording, and names() their names. A
  /// type describes bodies of the same construction.
  std::span<const std::uint32_t> ids() const { return ids_; }
  std::span<const std::string> types() const { return types_; }
  std::span<const std::string> names() const { return names_; }

  /// All bodies of the world as it was loaded, walls included. Each column has one entry per body, by BodyId.
  struct Scene {
    /// The name of the body, as the two members of engine::Name: "r17" is the word "r" and the number 17.
    /// `word` is an index into the list `words` of /world.
    std::vector<std::uint32_t> word, number;
    std::vector<std::uint32_t> type;  ///< index into the types of /world
    std::vector<double> pose;         ///< x, y, z (m) and heading (rad), world frame
    std::vector<float> color;         ///< red, green, blue, opacity
  };
  /// Returns the scene. Empty if the recording is so old that it has no scene.
  std::optional<Scene> scene() const;

  /// The number of complete frames, and the tick, simulated time and state hash of each. Ticks increase from
  /// frame to frame.
  std::size_t frames() const { return ticks_.size(); }
  std::span<const std::uint64_t> ticks() const { return ticks_; }
  std::span<const double> times_s() const { return times_s_; }
  std::span<const std::uint64_t> hashes() const { return hashes_; }

  /// One array of the state.
  struct Array {
    std::string component;     ///< name of its component, such as "pose" or "sensors/minibot/ranger:0"
    engine::StateField field;  ///< name, element type, number of columns, unit and meaning
    std::string frame;  ///< coordinate frame of the values, such as "world", "body" or "sensor"; empty: none
    std::vector<std::uint32_t> bodies;  ///< for each row, the index of its body in ids()
    Hdf5Dataset dataset;                ///< the values: frames x rows x columns
    std::size_t row_bytes() const { return field.columns * engine::element_size(field.element); }
  };
  /// All arrays, in the order in which a tick computes them: sensors, memories of controllers, velocities,
  /// poses.
  std::span<const Array> arrays() const { return arrays_; }
  /// Returns, for each row of an array, 1 if the body of the row has Array::component, else 0. The row of a
  /// body without this component holds NaN in all frames, or 0 if the array has integers.
  std::vector<std::uint8_t> has(const Array& array) const;
  /// Returns, for each body in ids(), 1 if it is in the world in the frame with this index, else 0. All are 1
  /// if the recording does not store this.
  std::vector<std::uint8_t> alive(std::size_t frame) const;
  /// Reads the frame with this index, below frames(), of an array in row-major order. `into` must have
  /// row_bytes() bytes for each row of the array.
  void read(const Array& array, std::size_t frame, std::span<std::byte> into) const;

 private:
  void find_arrays(const Hdf5Group& group, const std::string& component,
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

/// Whether a name selects the component of an array. As in engine::selects(), the name can be that of the
/// component, the part of that name before the first slash, or the name that the world file gives the device
/// or joint. In addition, KIND/NAME and TYPE/NAME select a device: `led/lamp` and `minibot/lamp` select
/// `sensors/minibot/lamp`. Recordings do not store kinds, so KIND may be any word that is not the name of
/// another type.
bool selects(std::string_view name, const RecordingReader::Array& array, const RecordingReader& recording);
/// Converts a name of a component or field that has the spelling of earlier versions of Troupe: with the path
/// of a sensor, or with a slash before the field. Returns "eye.ranges" for "sensors/minibot/eye.ranges" and
/// "eye/ranges", and "eye" for "sensors/minibot/eye". If devices of several types have the name "eye", the
/// result has the type: "minibot/eye.ranges". Empty if `name` is not such a spelling of something in the
/// recording.
std::optional<std::string> present_name(std::string_view name, const RecordingReader& recording);
/// Returns the name under which user interfaces show a component: `lamp (minibot)` for
/// `sensors/minibot/lamp`, and for components of /state the name that engine::given_name() returns: `arm` for
/// `joint/arm`, `pose` for `pose`.
std::string shown_name(std::string_view component);

}  // namespace troupe::worldio
