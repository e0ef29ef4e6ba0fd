#pragma once

#include "engine/kinds/kinds.hpp"
#include "engine/spec/world_spec.hpp"

namespace troupe::worldio {

/// Compares `spec`, the description of a world, with `back`, the same world after it was written as a
/// `.world` file and read again. Such files have the syntax of Stage, an older robot simulator. Compares the
/// length of a tick (simulation step), the bodies, their aliases (second names) and their types; other
/// settings of the world are not compared. Each difference that changes the behaviour is an error at the
/// place of the value in `spec`, because a `.world` file cannot express the value. These differences are
/// warnings: an outline, a size or a pose of a part that differs only by rounding, a heading that differs by
/// whole turns, and another name of a type. A part is a rigid piece of a body. For parts without solids, only
/// the aliases are compared.
void check_stage_round_trip(const engine::WorldSpec& spec, const engine::WorldSpec& back,
                            const engine::Registry& registry, Diagnostics& diagnostics);

}  // namespace troupe::worldio
