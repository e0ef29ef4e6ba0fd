#pragma once

#include "engine/world.hpp"
#include "sensors/ranger_beams.hpp"

namespace troupe::sensors {

/// Writes the readings of a batch with the grid ray engine, which the world must have (World::ray_grid()).
/// The percepts are those of ranger_kind(), up to the errors of the cells (docs/sensing.md).
void cast_grid(const engine::DeviceBatch& batch, const RangerBeams& ranger);

}  // namespace troupe::sensors
