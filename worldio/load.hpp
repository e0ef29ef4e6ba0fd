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

/// Gives the bodies of the world's populations the poses and random colours of another seed. `bodies` is
/// WorldSpec::bodies of the loaded world. Throws InputError, as the loader does, if a population does not
/// fit. Thread-safe.
using PlaceAgain = std::function<void(std::vector<engine::BodySpec>& bodies, std::uint64_t seed)>;

/// Options of a load, among them the changes that the command line makes to a world.
struct LoadOptions {
  std::optional<std::uint64_t> seed;  ///< replaces the seed of the world
  /// Sizes of populations: name -> count. An empty name means the world's only population.
  std::vector<std::pair<std::string, std::size_t>> robots;
  /// JSON pointer -> value as text ("/populations/0/count" -> "500"). Text that is not JSON becomes a string.
  std::vector<std::pair<std::string, std::string>> set;
  /// Folders searched, by file name, for a world or include file that does not exist at its given path.
  std::vector<std::filesystem::path> search_path;
  /// Threads that load; 0: one per available processor. The number changes no result and no message.
  unsigned threads = 0;
  /// Maximum number of bodies in the populations of a world. Programs that read untrusted files set it lower.
  double most_bodies = 10000000;
  /// If not null, the loader assigns it. It stays empty if the world has no populations.
  PlaceAgain* place_again = nullptr;
};

/// Reads a world file: Stage's syntax if its name ends in `.world`, Troupe's JSON if it ends in `.json`; any
/// other ending is an error. Collects all errors in `diagnostics`; do not use the result if there are any.
engine::WorldSpec load_world(const std::filesystem::path& file, const engine::Registry& registry,
                             const LoadOptions& options, Diagnostics& diagnostics);

/// Like load_world(), from the text of a world. `file` is its name in messages, selects the syntax by its
/// ending, and is the base of relative paths; it need not exist.
engine::WorldSpec load_world_text(const std::filesystem::path& file, std::string text,
                                  const engine::Registry& registry, const LoadOptions& options,
                                  Diagnostics& diagnostics);

/// The readers of the two syntaxes. `text` is the file's content; `file` is its name in messages and the base
/// of relative paths.
engine::WorldSpec load_stage_world(const std::filesystem::path& file, std::string text,
                                   const engine::Registry& registry, const LoadOptions& options,
                                   Diagnostics& diagnostics);
engine::WorldSpec load_json_world(const std::filesystem::path& file, const std::string& text,
                                  const engine::Registry& registry, const LoadOptions& options,
                                  Diagnostics& diagnostics);

}  // namespace troupe::worldio
