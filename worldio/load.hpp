#pragma once

#include "base/diagnostics.hpp"
#include "engine/kinds/kinds.hpp"
#include "engine/spec/world_spec.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace troupe::worldio {

/// A function that places the populations of a loaded world again, with another seed. A population is a group
/// of bodies of one type that a rule places in a region. It can have a reserve: bodies that are absent at the
/// start and can enter the world (be born) later. The argument `bodies` must be a copy of WorldSpec::bodies
/// of this world. For each body of a population, the function overwrites the pose and, if colours of the
/// population are random, the colour in `bodies` with the values that follow from `seed`. Bodies of a reserve
/// keep the poses that `bodies` has for them: each of these bodies gets its real pose when it is born. The
/// function throws InputError if a population does not fit into its region; some of `bodies` are then already
/// overwritten. Several threads may call it at the same time.
using PlaceAgain = std::function<void(std::vector<engine::BodySpec>& bodies, std::uint64_t seed)>;

/// Options of the functions that load a world. The members `seed`, `robots` and `set` are changes to the
/// world, which a user makes on the command line.
struct LoadOptions {
  /// Seed to use in place of that of the world; empty: the seed of the world.
  std::optional<std::uint64_t> seed;
  /// New sizes of populations: pairs of the name of a population and its new number of bodies. An empty name
  /// means the only population of the world. An unknown name is an error, as is any entry for a world without
  /// populations, such as a `.world` file.
  std::vector<std::pair<std::string, std::size_t>> robots;
  /// Values that replace values of the world, or are added to it: pairs of a JSON pointer to the value in the
  /// JSON world and the new value as JSON text, such as {"/populations/0/count", "500"}. A new value that is
  /// not JSON becomes a string. For a `.world` file, the pointers refer to the JSON world that
  /// write_json_world() makes of it.
  std::vector<std::pair<std::string, std::string>> set;
  /// Folders in which the loader looks for a world file, or for a file that a `.world` file includes, if
  /// there is no file at the given path. It searches these folders in their order, for a file whose name is
  /// the last component of the path. Files that a JSON world includes are not searched for in these folders.
  std::vector<std::filesystem::path> search_path;
  /// Number of threads that load the world; 0: one per available processor. The number changes no result and
  /// no message.
  unsigned threads = 0;
  /// Greatest number of bodies of a JSON world; more are an error. The number includes the ground (body 0 of
  /// every world), floor plans (bodies that consist of walls) and the reserves of populations. Programs that
  /// read untrusted files set a lower limit. The limit does not apply to `.world` files.
  double most_bodies = 10000000;
  /// If not null: the object in which the loader stores a function that places the populations of this world
  /// again. The loader leaves the object unchanged if the world has no populations or has errors.
  PlaceAgain* place_again = nullptr;
  /// If not null: the list to which the loader adds the names of all base types of a JSON world: the types
  /// from which other types inherit with the key `extends`. A name is added once for each type that extends
  /// the base type.
  std::vector<std::string>* base_types = nullptr;
  /// If not null: the list to which the loader adds the names of the populations of a JSON world.
  std::vector<std::string>* populations = nullptr;
};

/// Reads a world file and returns its spec, the description of the world from which the engine builds an
/// engine::World. The content must have the syntax of Stage, an older robot simulator, if the name of the
/// file ends in `.world`. It must be Troupe's JSON if the name ends in `.json`. Any other ending is an error,
/// as is a file that is missing or cannot be read. All errors and warnings are added to `diagnostics`. Do not
/// use the result if there are errors. `registry` lists the kinds (sorts) of drives, devices, controllers,
/// measures and faults that the world may use.
engine::WorldSpec load_world(const std::filesystem::path& file, const engine::Registry& registry,
                             const LoadOptions& options, Diagnostics& diagnostics);

/// Like load_world(), but reads the world from `text`, the content of a world file. `file` is the path of
/// this file in messages. Its ending selects the syntax, and relative paths in the world are relative to its
/// folder. The file need not exist.
engine::WorldSpec load_world_text(const std::filesystem::path& file, std::string text,
                                  const engine::Registry& registry, const LoadOptions& options,
                                  Diagnostics& diagnostics);

/// The readers of the two syntaxes, Stage's and JSON, which load_world_text() calls. These functions do not
/// check the ending of `file`. `text` is the content of the world file. `file` is the path of this file in
/// messages, and relative paths in the world are relative to its folder.
engine::WorldSpec load_stage_world(const std::filesystem::path& file, std::string text,
                                   const engine::Registry& registry, const LoadOptions& options,
                                   Diagnostics& diagnostics);
engine::WorldSpec load_json_world(const std::filesystem::path& file, const std::string& text,
                                  const engine::Registry& registry, const LoadOptions& options,
                                  Diagnostics& diagnostics);

}  // namespace troupe::worldio
