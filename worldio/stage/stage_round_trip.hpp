#pragma once

#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"

namespace troupe::worldio {

/// Compares a world `spec` with `back`, the same world after it was written in Stage's syntax and read again.
/// Each difference that changes the behaviour is an error at the place of the value in `spec`, because a
/// `.world` file cannot express the value. Outlines and sizes that differ only by rounding are warnings.
/// Parts without a body and aliases are not compared.
void check_stage_round_trip(const engine::WorldSpec& spec, const engine::WorldSpec& back,
                            const engine::Registry& registry, Diagnostics& diagnostics);

}  // namespace troupe::worldio
