#pragma once

#include "engine/state_table.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace troupe::worldio {

/// A recording (docs/recordings.md), read frame by frame: a closed one, one that is being written, or one
/// that was cut off. Everything throws Hdf5Error with the file's name.
class RecordingReader {
 public:
  explicit RecordingReader(const std::filesystem::path& file);

  /// /meta of an HDF5 file. Throws where the file is no recording, or of another layout than ours.
  static Hdf5Group checked_meta(const Hdf5File& file);

  const std::filesystem::path& file() const { return hdf5_.file_name(); }
  /// Its writer is still at it, or was killed: `troupe repair` then makes it readable for plain tools.
  bool unfinished() const { return unfinished_; }
  /// The attributes of /meta, as texts.
  const std::map<std::string, std::string>& meta() const { return meta_; }
  std::uint64_t every_ticks() const { return every_ticks_; }
  std::string world_json() const { return hdf5_.read_text("world"); }

  /// The bodies, a row of /state each: in the order of their ids.
  std::span<const std::uint32_t> ids() const { return ids_; }
  std::span<const std::string> types() const { return types_; }
  std::span<const std::string> names() const { return names_; }

  /// Every body of the world as it was loaded, by BodyId: an entry each, walls too.
  struct Scene {
    std::vector<std::uint32_t> word, number;  ///< engine::Name, of the words in /world
    std::vector<std::uint32_t> type;          ///< index into the types of /world
    std::vector<double> pose;                 ///< x, y, z (m) and heading (rad), world frame
    std::vector<float> color;                 ///< red, green, blue, opacity
  };
  /// Nothing where the recording is from before there was one.
  std::optional<Scene> scene() const;

  /// Whole frames, and what is known of each.
  std::size_t frames() const { return ticks_.size(); }
  std::span<const std::uint64_t> ticks() const { return ticks_; }
  std::span<const double> times_s() const { return times_s_; }
  std::span<const std::uint64_t> hashes() const { return hashes_; }

  /// One array of the state.
  struct Array {
    std::string component;  ///< "pose", "wander/0", "sensors/minibot/ranger:0"
    engine::StateField field;
    std::string frame;
    std::vector<std::uint32_t> bodies;  ///< a row each: its place in ids()
    Hdf5Dataset dataset;
    std::size_t row_bytes() const { return field.columns * engine::element_size(field.element); }
  };
  /// In the order in which a tick makes them: sensors, memories, velocities, poses.
  std::span<const Array> arrays() const { return arrays_; }
  /// Whether each row of an array is of a body that has the component, 1 or 0: the others hold NaN, or 0.
  std::vector<std::uint8_t> has(const Array& array) const;
  /// Which bodies are there in a frame, 1 or 0 each.
  std::vector<std::uint8_t> alive(std::size_t frame) const;
  /// One frame of an array, row-major; `into` takes as many bytes as its rows have.
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

}  // namespace troupe::worldio
