#pragma once

#include "base/diagnostics.hpp"
#include "engine/world.hpp"
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

/// A checkpoint: everything that a run goes on from, in one sealed HDF5 file
/// (worldio/results/sealed_file.hpp).
///
/// `/meta`        attributes: layout, tick, time_s, state_hash, what was counted, and the header it was given
/// `/world`       the spec as JSON (worldio/json/spec_json.hpp), without
/// `/bodies`      its bodies, a column for each of their fields, and
/// `/aliases`     their other names
/// `/tables/<component>/<field>`  the state [rows, columns], by the tables' own descriptions; rows by id,
///                which stand in `/tables/<component>/bodies`
/// `/bodies/subscribed`  ids of the bodies whose sensors the program itself had run
/// `/memories/<name>`  bytes that what looks on remembers of earlier ticks: beside the state, not of it
inline constexpr std::string_view k_checkpoint_kind = "checkpoint";
inline constexpr unsigned k_checkpoint_layout = 1;

/// What looks on remembers of earlier ticks, under a name each: no part of the state.
using Memories = std::map<std::string, std::vector<std::byte>>;

/// What a file of ours says of the run that made it: version, world, seed, effective options.
using FileHeader = std::vector<std::pair<std::string, std::string>>;

/// Saves the world as it is between two ticks. Throws std::runtime_error that names the file where it cannot
/// be written, or the world cannot be said in it; a checkpoint of this name is then what it was before.
void write_checkpoint(const std::filesystem::path& file, engine::World& world,
                      const engine::Registry& registry, const FileHeader& header,
                      const Memories& memories = {});

/// A checkpoint that was found whole. Whatever is wrong with it, here or later, is an InputError
/// `run.h5: error: ...`.
class Checkpoint {
 public:
  explicit Checkpoint(const std::filesystem::path& file);

  const std::filesystem::path& file() const { return file_; }
  std::uint64_t tick() const { return tick_; }
  double time_s() const { return time_s_; }
  std::uint64_t state_hash() const { return state_hash_; }
  /// The texts of /meta; the header among them.
  const std::map<std::string, std::string>& header() const { return header_; }
  /// One of them, empty where it is not there.
  std::string header(const std::string& key) const;

  /// What the world of the run is made of, with `changes` as --set gives them (restore_spec).
  engine::WorldSpec spec(const engine::Registry& registry,
                         std::span<const std::pair<std::string, std::string>> changes,
                         Diagnostics& diagnostics) const;
  Memories memories() const;
  /// Puts the state into a world that was made from spec().
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

/// Whether the file begins as a checkpoint does.
bool is_checkpoint(const std::filesystem::path& file);

}  // namespace troupe::worldio
