#pragma once

#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"

namespace troupe::worldio {

/// Reports in what `back`, a world that was written in Stage's syntax and read again, would do something else
/// than `spec`: each an error at its place in `spec`, for want of a word. Parts that are there only to carry
/// a device, sizes as declared, and other names do not count; outlines that differ by rounding are warnings.
void check_stage_round_trip(const engine::WorldSpec& spec, const engine::WorldSpec& back,
                            const engine::Registry& registry, Diagnostics& diagnostics);

}  // namespace troupe::worldio
