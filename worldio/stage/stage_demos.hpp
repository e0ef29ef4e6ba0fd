#pragma once

#include "engine/kinds/kinds.hpp"

#include <cstdint>
#include <string_view>

namespace troupe::worldio {

// Two controllers of the examples of Stage, an older robot simulator whose `.world` files Troupe reads. A
// model in such a file is a body or a part of a body. These controllers change their model when a file is
// read; they do not act while the world runs.

/// The controller `dynamic`. When a `.world` file is read, the controller adds `count` (by default 100)
/// children to its model: boxes with edges of 0.1 m that stand on the model. Their headings and their
/// positions are uniformly random; the positions are at most `reach` (by default 1 m) from the origin of the
/// model along x and along y. The random numbers depend only on the seed and on the name of the model within
/// its body. Bodies with equal text in the file therefore get equal boxes. The controller does nothing while
/// the world runs.
engine::ControllerKind dynamic_controller();

/// The controller `lasernoise`. When a `.world` file is read, the controller gives a normally distributed
/// error (`noise_relative`) to the readings of the first transducer (fan of beams) of its model, which must
/// be a ranger. The standard deviation of the error is `share` (by default 0.05) times the reading. Stage's
/// controller multiplies each reading by a random factor instead. A JSON world sets `noise_relative` of the
/// ranger directly. While the world runs, the controller only keeps its ranger running.
engine::ControllerKind lasernoise_controller();

/// A function that makes the changes of a controller `dynamic` or `lasernoise` when a file is read. It
/// changes `type`, which is the type of the body that has the controller. `params` are the parameters of the
/// controller, `seed` is that of the world, `registry` has the kinds of devices, and `part` is the index in
/// TypeSpec::parts of the part that has the controller.
using StageAddition = void (*)(const engine::Record& params, std::uint64_t seed,
                               const engine::Registry& registry, engine::TypeSpec& type, std::uint32_t part);

/// Returns the function for a controller of the kind with the name `controller`; null for all kinds except
/// `dynamic` and `lasernoise`.
StageAddition stage_addition(std::string_view controller);

}  // namespace troupe::worldio
