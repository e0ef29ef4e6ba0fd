#pragma once

#include "engine/world.hpp"
#include "sensors/ranger_beams.hpp"

namespace troupe::sensors {

/// Readings of a batch by the grid engine, which the world must have (World::ray_grid()):
/// percepts as ranger_kind() describes them, but for what cells make of them, docs/sensing.md.
void cast_grid(const engine::DeviceBatch& batch, const RangerBeams& ranger);

}  // namespace troupe::sensors
