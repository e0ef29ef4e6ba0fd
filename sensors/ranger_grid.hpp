#pragma once

#include "engine/world.hpp"
#include "sensors/ranger_beams.hpp"

namespace troupe::sensors {

/// Casts the beams of a ranger with the grid ray engine and writes the readings of a batch. The world must
/// have this engine (World::ray_grid()). The readings are those of the exact engine up to the errors of the
/// cells (docs/sensing.md).
void cast_grid(const engine::DeviceBatch& batch, const RangerBeams& ranger);

}  // namespace troupe::sensors
