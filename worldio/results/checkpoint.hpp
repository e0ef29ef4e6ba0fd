#pragma once

#include "base/diagnostics.hpp"
#include "engine/world/world.hpp"
#include "worldio/json/spec_json.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Saves and restores checkpoints. A checkpoint is one HDF5 file from which a run can be continued; a hash in
/// the file detects damage. A spec (engine::WorldSpec) is the description from which the engine builds a
/// world. The id of a body is its index in the spec. A tick is a time step. The state of a world
/// consists of tables, one for each *component*, such as `pose`. The table of a component has one row for
/// each body that has this component, and one or more fields, such as `x`. An *observer* reads the state of a
/// world and does not change it. For example, measures, which compute a number such as the covered area, are
/// observers.
///
/// A checkpoint has these groups and datasets:
///
/// `/meta`        attributes: `layout`, `tick`, `time_s`, `state_hash`, counters of the run such as `beams`
///                (number of rays that all sensors have cast), and the FileHeader that the caller gives
/// `/world`       the spec as JSON (worldio/json/spec_json.hpp), without its bodies and aliases
/// `/bodies`      the bodies of the spec: one array for each property, as in BodyColumns
///                (worldio/json/spec_json.hpp)
/// `/aliases`     second names of bodies, in the same form
/// `/tables/<component>/bodies`   for each row of this table, the id of its body
/// `/tables/<component>/<field>`  one field of this table, as an array [rows, values per row]
/// `/bodies/subscribed`  ids of the bodies to whose sensors a program has subscribed
/// (CommittedView::subscribed())
/// `/memories/<name>`    an entry of Memories
namespace troupe::worldio {

/// The arguments `kind` and `layout` with which write_checkpoint() calls write_sealed()
/// (worldio/results/sealed_file.hpp), which writes the file. `layout` is the version of the list of groups
/// and datasets at the top of this header.
inline constexpr std::string_view k_checkpoint_kind = "checkpoint";
inline constexpr unsigned k_checkpoint_layout = 1;

/// Data that parts of the program keep from tick to tick, and that are not part of the state. Most of them
/// belong to observers, such as the area covered so far. Each entry has the name of its owner, and bytes in a
/// format that only the owner reads. A checkpoint does not store an entry without bytes.
using Memories = std::map<std::string, std::vector<std::byte>>;

/// What a result file says about the run that wrote it: pairs of a key and a text, such as the version, the
/// world, the seed and the options.
using FileHeader = std::vector<std::pair<std::string, std::string>>;

/// Saves the present state of `world` as a checkpoint. `registry` must have the kinds (sorts) of drives,
/// devices, controllers, measures and faults of the world. `header` is stored as attributes of /meta. If
/// `header` has a key several times, the last text is stored. A key must differ from the attributes that
/// every checkpoint has, such as "tick". Throws std::runtime_error, with the name of the file, if the file
/// cannot be written or the world cannot be stored. An existing file of this name is then unchanged.
void write_checkpoint(const std::filesystem::path& file, engine::World& world,
                      const engine::Registry& registry, const FileHeader& header,
                      const Memories& memories = {});

/// A checkpoint file that is open for reading. The constructor, spec(), memories() and restore() throw
/// InputError if the file cannot be read or is not a valid checkpoint. The message begins with the name of
/// the file, as in `run.h5: error: ...`.
class Checkpoint {
 public:
  /// Opens a checkpoint. Checks, by the hash in the file, that the file is undamaged.
  explicit Checkpoint(const std::filesystem::path& file);

  const std::filesystem::path& file() const { return file_; }
  /// The number of ticks that were completed when the state was saved.
  std::uint64_t tick() const { return tick_; }
  double time_s() const { return time_s_; }
  std::uint64_t state_hash() const { return state_hash_; }
  /// The texts among the attributes of /meta: the FileHeader of the file, and `state_hash` in hexadecimal
  /// digits.
  const std::map<std::string, std::string>& header() const { return header_; }
  /// Returns the text of one key of header(); empty if there is no such key.
  std::string header(const std::string& key) const;

  /// Returns the spec, with `changes` applied. Each change is a JSON pointer into /world and the new value as
  /// JSON text, as in `troupe resume --set`. k_changeable (worldio/json/spec_json.hpp) lists the allowed
  /// pointers. Changes of parameters are added to `parameters` instead; pass them to World::set() after
  /// restore(). Errors in the spec or in the changes are added to `diagnostics`; do not use the result if
  /// there are errors.
  engine::WorldSpec spec(const engine::Registry& registry,
                         std::span<const std::pair<std::string, std::string>> changes,
                         Diagnostics& diagnostics, std::vector<ParameterChange>& parameters) const;
  /// Returns the Memories that were saved with the state; empty if the file has none.
  Memories memories() const;
  /// Sets the state of `world` to that of the checkpoint. `world` must have been built from spec(). Throws
  /// InputError in these cases:
  /// - /bodies/subscribed contains a body that does not exist or is static. The state of the world is then
  ///   unchanged.
  /// - The tables of the world differ from those in the file in their names, fields or bodies. The world is
  ///   then in its initial state.
  /// - The restored state is invalid, or its hash differs from state_hash(). The world is then in its initial
  ///   state.
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

/// Whether the first line of a file is that of a checkpoint. Reads only this line, so the rest of the file
/// may be damaged. False if the file cannot be read.
bool is_checkpoint(const std::filesystem::path& file);

}  // namespace troupe::worldio
