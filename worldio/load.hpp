#pragma once

#include "base/diagnostics.hpp"
#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace troupe::worldio {

/// A function that places the populations of a world again: it gives their bodies the poses and random
/// colours that they have with another seed. `bodies` is a copy of WorldSpec::bodies of the loaded world,
/// which the function changes. It throws InputError, as the loader does, if a population does not fit into
/// its region. It may be called from several threads at the same time.
using PlaceAgain = std::function<void(std::vector<engine::BodySpec>& bodies, std::uint64_t seed)>;

/// Options of the loader, among them the changes that the command line makes to a world.
struct LoadOptions {
  std::optional<std::uint64_t> seed;  ///< replaces the seed of the world
  /// New sizes of populations: pairs of a name and a count. An empty name means the only population of the
  /// world.
  std::vector<std::pair<std::string, std::size_t>> robots;
  /// Values that replace those of a JSON world: pairs of a JSON pointer and a value as JSON text, such as
  /// {"/populations/0/count", "500"}. Text that is not JSON becomes a string.
  std::vector<std::pair<std::string, std::string>> set;
  /// Folders in which the loader looks for a world file or an included file that does not exist at its given
  /// path. It looks for the file name without its folder.
  std::vector<std::filesystem::path> search_path;
  /// Number of threads that load; 0: one per available processor. It changes no result and no message.
  unsigned threads = 0;
  /// Maximum number of bodies in the populations of a world. Programs that read untrusted files set it lower.
  double most_bodies = 10000000;
  /// If not null, the loader assigns a PlaceAgain to the object to which this points. The object stays empty
  /// if the world has no populations.
  PlaceAgain* place_again = nullptr;
};

/// Reads a world file: Stage's syntax if its name ends in `.world`, Troupe's JSON if it ends in `.json`. Any
/// other ending is an error. All errors and warnings are added to `diagnostics`; do not use the result if
/// there are errors.
engine::WorldSpec load_world(const std::filesystem::path& file, const engine::Registry& registry,
                             const LoadOptions& options, Diagnostics& diagnostics);

/// Like load_world(), but reads the world from `text`. `file` is the name of the world in messages, selects
/// the syntax by its ending, and is the base of relative paths. The file need not exist.
engine::WorldSpec load_world_text(const std::filesystem::path& file, std::string text,
                                  const engine::Registry& registry, const LoadOptions& options,
                                  Diagnostics& diagnostics);

/// The readers of the two syntaxes, which load_world_text() calls. `text` is the content of the file. `file`
/// is its name in messages and the base of relative paths.
engine::WorldSpec load_stage_world(const std::filesystem::path& file, std::string text,
                                   const engine::Registry& registry, const LoadOptions& options,
                                   Diagnostics& diagnostics);
engine::WorldSpec load_json_world(const std::filesystem::path& file, const std::string& text,
                                  const engine::Registry& registry, const LoadOptions& options,
                                  Diagnostics& diagnostics);

}  // namespace troupe::worldio
