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
  std::size_t bodies = 0;  ///< number of bodies, without the ground, which is body 0 of every world
  /// Number of body types that these bodies use; a type describes bodies of the same construction.
  std::size_t types = 0;
};

/// Reads the world file `from` and returns its world as the text of a world file named `to`. Does not write
/// the file `to`. Both names must end in `.world` (the syntax of Stage, an older robot simulator) or `.json`
/// (Troupe's own format). The ending selects the format. Paths of images in the text are relative to the
/// folder of `to`. Macros of a `.world` file, and presets (named sets of parameters for controllers) of a
/// JSON world, are replaced by their content. A population (a group of bodies that a rule places) becomes one
/// entry per body. The function reports an error for everything in `from` that the new format cannot express.
/// If the new format is `.world`, it also reports a warning for each outline, size or pose that is rounded,
/// for each heading that is wrapped into [-pi, pi], and for bounds (the box in which bodies must stay) that a
/// JSON world takes from its floor plans, because a `.world` file has no bounds. Without such a warning, a
/// run of the new world has the same state hash at every tick (simulation step) as a run of the old world. Do
/// not use the result if `diagnostics` has errors.
///
/// registry: the kinds (sorts) of drives, devices, controllers, measures and faults that both worlds may use.
///
/// options: the options with which `from` is loaded.
///
/// loaded: a function that is called with the world of `from` before the conversion. `loaded` may be empty.
/// It is not called if loading `from` reports errors. convert_world() does not catch exceptions that `loaded`
/// throws.
ConvertedWorld convert_world(const std::filesystem::path& from, const std::filesystem::path& to,
                             const engine::Registry& registry, const LoadOptions& options,
                             Diagnostics& diagnostics,
                             const std::function<void(const engine::WorldSpec&)>& loaded = {});

}  // namespace troupe::worldio
