#pragma once

#include "engine/kinds/registry.hpp"
#include "engine/spec/world_spec.hpp"

namespace troupe::worldio {

/// Compares a world with the same world after it was written as a `.world` file and read again. `.world`
/// files have the syntax of Stage, an older robot simulator, which cannot express every world. `spec` is the
/// description of the original world, and `back` is the description that was read from the `.world` file. A
/// part is a rigid piece of a body.
///
/// The function compares the length of a tick (time step), the bodies, their aliases (second names) and
/// their types. Other settings of the world are not compared. Of parts without solids, only the aliases are
/// compared.
///
/// Each difference that changes the behaviour of the world is an error. The error has the place of the value
/// in the file from which `spec` was read. Some differences are only warnings:
/// - an outline, a size or a pose of a part that differs by rounding (at most 1e-9 m or rad),
/// - an outline whose corners are listed in the opposite order,
/// - a heading that differs by whole turns,
/// - another name of a type.
void check_stage_round_trip(const engine::WorldSpec& spec, const engine::WorldSpec& back,
                            const engine::Registry& registry, Diagnostics& diagnostics);

}  // namespace troupe::worldio
