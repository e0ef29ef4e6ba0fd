#pragma once

#include "engine/kinds.hpp"

#include <cstdint>
#include <string_view>

namespace troupe::worldio {

/// Two controllers of Stage's examples that change their model when a `.world` file is read, and nothing
/// while the world runs.

/// Adds `count` children, boxes of 0.1 m, to its model when a `.world` file is read: standing on it, at poses
/// drawn uniformly within `reach` of its origin in x and y. They follow from the seed and the model's name
/// within its body: bodies written alike are alike. Does nothing while the world runs.
engine::ControllerKind dynamic_controller();

/// Gives the first transducer of its ranger a normal error of 5 % of each reading (`noise_relative`) when a
/// `.world` file is read; Stage's multiplies what was read. In JSON the ranger says so itself. Does nothing
/// while the world runs but have its ranger run.
engine::ControllerKind lasernoise_controller();

/// Changes the type of a model of a `.world` file that has a controller of Stage's examples: `params` are the
/// controller's, `seed` is the world's, `part` is the part that the controller belongs to.
using StageAddition = void (*)(const engine::Record& params, std::uint64_t seed,
                               const engine::Registry& registry, engine::TypeSpec& type, std::uint32_t part);

/// What a controller of this kind adds to its model; null where it adds nothing.
StageAddition stage_addition(std::string_view controller);

}  // namespace troupe::worldio
