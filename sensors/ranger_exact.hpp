#pragma once

#include "engine/kinds.hpp"
#include "sensors/ranger_beams.hpp"

namespace troupe::sensors {

/// Casts the beams of a ranger with the exact ray engine for all rows of the batch, and writes their
/// readings. The caller applies add_extras() afterwards.
void cast_exact(const engine::DeviceBatch& batch, const RangerBeams& ranger);

}  // namespace troupe::sensors
