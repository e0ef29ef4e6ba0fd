#pragma once

#include "engine/world.hpp"
#include "sensors/ranger_beams.hpp"

namespace troupe::sensors {

/// Writes the readings of a batch with the exact ray engine.
void cast_exact(const engine::DeviceBatch& batch, const RangerBeams& ranger);

}  // namespace troupe::sensors
