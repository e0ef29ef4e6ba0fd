#pragma once

#include "engine/kinds/registry.hpp"
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

/// Converts a world file. Reads the file `from`, and returns its world as the text of a file with the name
/// `to`. Does not write the file `to`. Each of the two names must end in `.world` (the syntax of Stage, an
/// older robot simulator) or `.json` (Troupe's own format). The ending selects the format.
///
/// The text differs from the file `from`:
/// - Paths of images are relative to the folder of `to`.
/// - The content of a macro (in `.world` files) or of a preset (in JSON, a named set of parameters for a
///   controller) replaces its name.
/// - A population (in JSON, a group of bodies that a rule places) becomes one entry per body.
///
/// Everything in `from` that the new format cannot express is an error. Do not use the result if
/// `diagnostics` has errors. If the new format is `.world`, there is a warning for
/// - each outline, size or pose that is rounded,
/// - each heading that is wrapped into [-pi, pi],
/// - bounds (the box in which bodies must stay) that follow from floor plans or from an arena with walls,
///   because a `.world` file has no bounds.
///
/// If there is none of these warnings, runs of both worlds have the same state hash at every tick (time
/// step).
///
/// registry  the kinds (sorts) of drives, devices, controllers, measures and faults that both worlds may use
/// options   the options with which `from` is loaded
/// loaded    a function that is called with the world of `from` before the conversion; may be empty. It is
///           not called if `from` has errors. convert_world() does not catch its exceptions.
ConvertedWorld convert_world(const std::filesystem::path& from, const std::filesystem::path& to,
                             const engine::Registry& registry, const LoadOptions& options,
                             Diagnostics& diagnostics,
                             const std::function<void(const engine::WorldSpec&)>& loaded = {});

}  // namespace troupe::worldio
