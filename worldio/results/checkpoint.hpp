#pragma once

#include "base/diagnostics.hpp"
#include "engine/world/world.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::worldio {

/// A checkpoint is one HDF5 file with everything that is needed to continue a run, and with a hash that
/// detects damage. These constants are its arguments `kind` (kind of file) and `layout` (version of the
/// layout) of write_sealed() (worldio/results/sealed_file.hpp), which writes the file and the hash. The state
/// of a world consists of tables, the components, such as `pose`; a component has one row for each body that
/// has these data. A tick is a simulation step. The groups and datasets of the file are:
///
/// `/meta`        attributes: layout, tick, time_s, state_hash, counts such as beams (rays that all sensors
///                cast) and stalled (robots whose last motion was blocked), and the FileHeader given by the
///                caller
/// `/world`       the spec (description of the world) as JSON (worldio/json/spec_json.hpp), without its
///                bodies and aliases
/// `/bodies`      the bodies of the spec, one column per field
/// `/aliases`     the other names of the bodies
/// `/tables/<component>/bodies`   ids of the bodies that have this component of the state, such as
///                                `pose`; one per row
/// `/tables/<component>/<field>`  one field of this component, as an array [rows, columns]
/// `/bodies/subscribed`  ids of the bodies to whose sensors a program subscribed: World::subscribed()
/// `/memories/<name>`    bytes that observers remember of earlier ticks; not part of the state
inline constexpr std::string_view k_checkpoint_kind = "checkpoint";
inline constexpr unsigned k_checkpoint_layout = 1;

/// What observers remember of earlier ticks. An observer reads the state of a world and does not change it.
/// Measures, which compute a number such as the covered area, are observers. The key is the name of an
/// observer. The bytes are in a format that only this observer reads, and they are not part of the state of
/// the world. A checkpoint does not store an entry without bytes.
using Memories = std::map<std::string, std::vector<std::byte>>;

/// What a result file says about the run that wrote it, as keys and values: version, world, seed, effective
/// options.
using FileHeader = std::vector<std::pair<std::string, std::string>>;

/// Saves the present state of `world` as a checkpoint. `registry` has the kinds (sorts) of drives, devices
/// and controllers of the world. `header` is added to /meta; if a key is repeated, the last value is stored.
/// No key of `header` may be the name of another attribute of /meta, such as "tick". Throws
/// std::runtime_error, with the name of the file, if the file cannot be written or if the world cannot be
/// stored. An existing checkpoint of this name is then unchanged.
void write_checkpoint(const std::filesystem::path& file, engine::World& world,
                      const engine::Registry& registry, const FileHeader& header,
                      const Memories& memories = {});

/// A checkpoint file that is open for reading. The constructor, spec(), memories() and restore() throw
/// InputError if the file is not a valid checkpoint. The message begins with the name of the file, as in
/// `run.h5: error: ...`.
class Checkpoint {
 public:
  /// Opens a file and checks, by the hash of its bytes, that it is an undamaged checkpoint.
  explicit Checkpoint(const std::filesystem::path& file);

  const std::filesystem::path& file() const { return file_; }
  /// The number of ticks that were completed when the state was saved.
  std::uint64_t tick() const { return tick_; }
  double time_s() const { return time_s_; }
  std::uint64_t state_hash() const { return state_hash_; }
  /// The attributes of /meta that are texts: the FileHeader of the file, and `state_hash`.
  const std::map<std::string, std::string>& header() const { return header_; }
  /// Returns the text of one key of header(); empty if there is no such key.
  std::string header(const std::string& key) const;

  /// Returns the spec (description of the world, from which the engine builds it), with `changes` applied. A
  /// change is a JSON pointer into the stored spec and a new value as JSON text, like an option --set of
  /// `troupe resume`; k_changeable (worldio/json/spec_json.hpp) lists the allowed pointers. Errors in the
  /// spec or in the changes are added to `diagnostics`; do not use the result if there are errors.
  engine::WorldSpec spec(const engine::Registry& registry,
                         std::span<const std::pair<std::string, std::string>> changes,
                         Diagnostics& diagnostics) const;
  /// Returns the bytes that observers remembered when the state was saved; empty if the file has none.
  Memories memories() const;
  /// Sets the state of `world`, which must have been built from spec(), to that of the checkpoint. Throws
  /// InputError if the tables of the world (their names, fields or bodies) differ from those in the file, or
  /// if the restored state does not have the hash that is stored in the file. The world is then in its
  /// initial state. Also throws InputError if /bodies/subscribed is wrong; the state of the world is then
  /// unchanged.
  void restore(engine::World& world) const;

 private:
  void restore_tables(std::span<engine::StateTable> tables) const;

  std::filesystem::path file_;
  Hdf5File hdf5_;
  std::uint64_t tick_ = 0;
  double time_s_ = 0;
  std::uint64_t state_hash_ = 0;
  engine::World::Counters counters_;
  std::map<std::string, std::string> header_;
};

/// Whether the first line of a file is that of a checkpoint. The rest of the file is not read, so it may be
/// damaged. False if the file cannot be read.
bool is_checkpoint(const std::filesystem::path& file);

}  // namespace troupe::worldio
