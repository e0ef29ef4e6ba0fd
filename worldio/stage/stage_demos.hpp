#pragma once

#include "base/result.hpp"
#include "engine/kinds/registry.hpp"

#include <cstdint>
#include <string_view>

namespace troupe::worldio {

// Two controllers of the examples of Stage, an older robot simulator whose `.world` files Troupe reads. A
// model in such a file is a body or a part of a body. These controllers change their model when a file is
// read; they do not act while the world runs.

/// Returns the controller kind `dynamic`. When a `.world` file is read, this controller adds boxes with edges
/// of 0.1 m to its model. While the world runs, it does nothing.
///
/// The parameter `count` is the number of boxes (by default 100). The boxes stand on top of the model. Their
/// headings and positions are uniformly random. The positions are at most `reach` (by default 1 m) from the
/// origin of the model along x and along y. The random numbers depend only on the seed of the world and on
/// the name of the model within its body. Two bodies with equal text in the file therefore get equal boxes.
engine::ControllerKind dynamic_controller();

/// Returns the controller kind `lasernoise`. The model of this controller must be a ranger. When a `.world`
/// file is read, the controller sets the parameter `noise_relative` of the first transducer (fan of beams) of
/// this ranger to `share` (by default 0.05). Each reading of the transducer then has a normally distributed
/// error with a standard deviation of `share` times the reading. Stage's controller multiplies each reading
/// by a random factor instead. A JSON world sets `noise_relative` directly.
///
/// While the world runs, the controller changes nothing. The ranger runs because a controller uses it.
engine::ControllerKind lasernoise_controller();

/// A function that changes a body type when a file is read, as the controller `dynamic` or `lasernoise`
/// requires.
/// params    the parameters of the controller
/// seed      the seed of the world
/// registry  the kinds (sorts) of devices
/// type      the type (description of bodies of the same construction) that has the controller
/// part      index in TypeSpec::parts of the part that has the controller
/// If the part has nothing that the controller can change, the function changes nothing and returns an error.
using StageAddition = Result<> (*)(const engine::Record& params, std::uint64_t seed,
                                   const engine::Registry& registry, engine::TypeSpec& type,
                                   std::uint32_t part);

/// Returns the function for controllers of the kind `controller`; null for all kinds except `dynamic` and
/// `lasernoise`.
StageAddition stage_addition(std::string_view controller);

}  // namespace troupe::worldio
