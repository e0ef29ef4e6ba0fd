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

/// Gives the bodies of a world the poses and the random colours that its populations have with another seed.
/// bodies: WorldSpec::bodies of the world that was read. Throws InputError as the loader does where bodies
/// find no place. May be called from several threads at once.
using PlaceAgain = std::function<void(std::vector<engine::BodySpec>& bodies, std::uint64_t seed)>;

/// What the command line changes in a world while it is read.
struct LoadOptions {
  std::optional<std::uint64_t> seed;
  /// Sizes of populations: name -> count; an empty name means the world's only population.
  std::vector<std::pair<std::string, std::size_t>> robots;
  /// JSON pointer -> value as text ("/populations/0/count" -> "500"); a text that is not JSON is a string.
  std::vector<std::pair<std::string, std::string>> set;
  /// Directories searched by base name for a world or include that is not where it was said to be.
  std::vector<std::filesystem::path> search_path;
  /// Threads that load; 0: one for each processor it may use. They change no result and no message.
  unsigned threads = 0;
  /// How many bodies the populations of a world may have: less than the default for who reads strangers'
  /// files.
  double most_bodies = 10000000;
  /// Where given, the loader sets it; to an empty one where no body of the world is placed by the seed.
  PlaceAgain* place_again = nullptr;
};

/// Reads a world: Stage syntax for `.world`, ours for `.json`; another ending is an error that says so.
/// Everything that is wrong is collected in `diagnostics`; the result is meaningless when it has errors.
engine::WorldSpec load_world(const std::filesystem::path& file, const engine::Registry& registry,
                             const LoadOptions& options, Diagnostics& diagnostics);

/// The same for a world whose text is at hand: `file` names it in messages, says by its ending which syntax
/// it has, and is the base of relative paths; it need not be there.
engine::WorldSpec load_world_text(const std::filesystem::path& file, std::string text,
                                  const engine::Registry& registry, const LoadOptions& options,
                                  Diagnostics& diagnostics);

/// The two readers behind them. `text` is the file's content, `file` names it and is the base of relative
/// paths.
engine::WorldSpec load_stage_world(const std::filesystem::path& file, std::string text,
                                   const engine::Registry& registry, const LoadOptions& options,
                                   Diagnostics& diagnostics);
engine::WorldSpec load_json_world(const std::filesystem::path& file, const std::string& text,
                                  const engine::Registry& registry, const LoadOptions& options,
                                  Diagnostics& diagnostics);

}  // namespace troupe::worldio
