#pragma once

#include "engine/kinds.hpp"

#include <cstdint>
#include <string_view>

namespace troupe::worldio {

/// Two controllers of Stage's examples. They change their model when a `.world` file is read and do nothing
/// while the world runs.

/// When a `.world` file is read, adds `count` children to its model: boxes of 0.1 m that stand on it, at
/// poses drawn uniformly within `reach`, m, of its origin in x and y. The draws depend only on the seed and
/// on the model's name within its body, so bodies with equal text stay equal. Does nothing while the world
/// runs.
engine::ControllerKind dynamic_controller();

/// When a `.world` file is read, gives the first transducer of its ranger a normally distributed error
/// (`noise_relative`) with a standard deviation of `share`, 5 % unless given, of each reading; Stage's
/// controller multiplies the readings instead. A JSON world sets `noise_relative` of the ranger directly.
/// While the world runs, it only keeps its ranger running.
engine::ControllerKind lasernoise_controller();

/// Applies one of these controllers to the type of its model. `params` are the controller's, `seed` is the
/// world's, `part` is the part that the controller belongs to.
using StageAddition = void (*)(const engine::Record& params, std::uint64_t seed,
                               const engine::Registry& registry, engine::TypeSpec& type, std::uint32_t part);

/// The function that applies a controller of this kind; null if the kind does not change its model.
StageAddition stage_addition(std::string_view controller);

}  // namespace troupe::worldio
