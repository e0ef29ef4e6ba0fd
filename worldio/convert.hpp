#pragma once

#include "engine/kinds/kinds.hpp"
#include "worldio/load.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

namespace troupe::worldio {

/// The result of convert_world(): the text of a world file, and the numbers of its bodies and types.
struct ConvertedWorld {
  std::string text;        ///< content of the new file
  std::size_t bodies = 0;  ///< number of bodies, without the ground (body 0)
  std::size_t types = 0;   ///< number of types that these bodies use
};

/// Reads the world file `from` and returns its world as the text of a world file named `to`. Does not write
/// the file `to`. Both names must end in `.world` (Stage's syntax) or `.json`. The ending selects the format.
/// Paths of images in the text are relative to the folder of `to`. Macros of a `.world` file, and presets
/// (named variants of controller kinds) of a JSON world, are expanded. Populations (groups of bodies that a
/// rule places) become one model per body. The function reports an error for everything in `from` that the
/// new format cannot express. If the new format is `.world`, it also reports a warning for each outline, size
/// or pose that is rounded, for each heading that is wrapped into [-pi, pi], and for the bounds that a JSON
/// world takes from its floor plans, because a `.world` file has no bounds. Without such a warning, a run of
/// the new world has the same state hash at every tick as a run of the old world. Do not use the result if
/// `diagnostics` has errors.
///
/// loaded: a function that is called with the world of `from` before the conversion. `loaded` may be empty,
/// and is not called if this world has errors. convert_world() does not catch exceptions of `loaded`.
ConvertedWorld convert_world(const std::filesystem::path& from, const std::filesystem::path& to,
                             const engine::Registry& registry, const LoadOptions& options,
                             Diagnostics& diagnostics,
                             const std::function<void(const engine::WorldSpec&)>& loaded = {});

}  // namespace troupe::worldio
