#pragma once

#include "engine/world.hpp"
#include "sensors/ranger_beams.hpp"

namespace troupe::sensors {

/// Casts the beams of a ranger with the exact ray engine and writes the readings of a batch.
void cast_exact(const engine::DeviceBatch& batch, const RangerBeams& ranger);

}  // namespace troupe::sensors
