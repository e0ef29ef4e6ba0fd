#pragma once

#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"

namespace troupe::worldio {

/// Compares `back`, a world that was written in Stage's syntax and read again, with `spec`. Each difference
/// in behaviour is an error at its place in `spec`: a `.world` file cannot express it. Parts without a body
/// and aliases are not compared; outlines and sizes that differ by rounding are warnings.
void check_stage_round_trip(const engine::WorldSpec& spec, const engine::WorldSpec& back,
                            const engine::Registry& registry, Diagnostics& diagnostics);

}  // namespace troupe::worldio
