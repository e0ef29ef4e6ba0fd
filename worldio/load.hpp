#pragma once

#include "base/diagnostics.hpp"
#include "base/result.hpp"
#include "engine/kinds/registry.hpp"
#include "engine/spec/world_spec.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// Loads worlds from files, which are in JSON or in the syntax of Stage, an older robot simulator. A spec
/// (engine::WorldSpec) is the description from which the engine builds a world. A population is a group of
/// bodies of one type that are placed by a rule in a region. Its reserve consists of bodies that are absent
/// at the start and can enter the world (be born) later. The ground is body 0 of every world. A floor plan is
/// a body that consists of walls.
namespace troupe::worldio {

/// A function that places the populations of a loaded world again, with another seed. `bodies` must be a copy
/// of WorldSpec::bodies of this world. The function overwrites the poses of the bodies of all populations. If
/// a population has random colours, it also overwrites the colours of the bodies and of the reserve. It does
/// not change the poses of bodies of a reserve, because these bodies get their poses when they are born.
/// Throws InputError if a population does not fit into its region; `bodies` may then be partly overwritten.
/// Several threads may call the function at the same time.
using PlaceAgain = std::function<void(std::vector<engine::BodySpec>& bodies, std::uint64_t seed)>;

/// Options of the functions that load a world. With `seed`, `robots` and `set`, a user changes the world on
/// the command line.
struct LoadOptions {
  /// Seed in place of that of the world; empty: the seed of the world.
  std::optional<std::uint64_t> seed;
  /// New sizes of populations: pairs of the name of a population and its new number of bodies. An empty name
  /// means the only population of the world. A name is an error if the world has no such population; a
  /// `.world` file never has populations.
  std::vector<std::pair<std::string, std::size_t>> robots;
  /// New values: pairs of a JSON pointer to a value of the JSON world and the new value as JSON text, such as
  /// {"/populations/0/count", "500"}. If the world does not have the value, it is added. A text that is not
  /// JSON is taken as a string. For a `.world` file, the pointers refer to the JSON world that
  /// write_json_world() makes of the file.
  std::vector<std::pair<std::string, std::string>> set;
  /// Folders that are searched, in their order, if there is no file at the path of the world file. The search
  /// is for the file name, the last component of this path. Files that a `.world` file includes are searched
  /// for in the same way; files that a JSON world includes are not.
  std::vector<std::filesystem::path> search_path;
  /// Number of threads that load the world; 0: one per available processor. The number changes no result and
  /// no message.
  unsigned threads = 0;
  /// Greatest number of bodies of a JSON world; more bodies are an error. The number includes the ground,
  /// floor plans and reserves. Programs that read untrusted files set a lower limit. The limit does not apply
  /// to `.world` files.
  double most_bodies = 10000000;
  /// If not null: the object in which the loader stores a function that places the populations of this world
  /// again. The loader leaves the object unchanged if the world has no populations or has errors.
  PlaceAgain* place_again = nullptr;
  /// If not null: the list to which the loader adds the names of the base types of a JSON world. A base type
  /// is a type from which another type inherits with the key `extends`. If several types extend a base type,
  /// its name is added once for each of them.
  std::vector<std::string>* base_types = nullptr;
  /// If not null: the list to which the loader adds the names of the populations of a JSON world.
  std::vector<std::string>* populations = nullptr;
};

/// Returns an error unless the name of a world file ends in `.world` or `.json`.
Result<> check_world_ending(const std::filesystem::path& file);

/// Reads a world file and returns its spec. The ending of the file name selects the syntax: `.world` that of
/// Stage, `.json` that of Troupe. Any other ending is an error, as is a file that is missing or cannot be
/// read. Adds all errors and warnings to `diagnostics`; do not use the result if there are errors. `registry`
/// lists the kinds (sorts) of drives, devices, controllers, measures and faults that the world may use.
engine::WorldSpec load_world(const std::filesystem::path& file, const engine::Registry& registry,
                             const LoadOptions& options, Diagnostics& diagnostics);

/// Like load_world(), but `text` is the content of the world file. `file` is the path of the file, which need
/// not exist. Its ending selects the syntax, messages name it, and relative paths in the world are relative
/// to its folder.
engine::WorldSpec load_world_text(const std::filesystem::path& file, std::string text,
                                  const engine::Registry& registry, const LoadOptions& options,
                                  Diagnostics& diagnostics);

/// The readers of the two syntaxes, which load_world_text() calls. Their parameters are those of
/// load_world_text(), but the ending of `file` does not matter.
engine::WorldSpec load_stage_world(const std::filesystem::path& file, std::string text,
                                   const engine::Registry& registry, const LoadOptions& options,
                                   Diagnostics& diagnostics);
engine::WorldSpec load_json_world(const std::filesystem::path& file, const std::string& text,
                                  const engine::Registry& registry, const LoadOptions& options,
                                  Diagnostics& diagnostics);

}  // namespace troupe::worldio
