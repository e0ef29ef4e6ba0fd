#pragma once

#include "engine/kinds/kinds.hpp"
#include "sensors/ranger_beams.hpp"

namespace troupe::sensors {

/// Casts the beams of a ranger with the exact ray engine for all bodies of the batch, and writes their
/// readings. The caller must then call add_extras(), which applies beam widths, noise of readings and lower
/// limits.
void cast_exact(const engine::DeviceBatch& batch, const RangerBeams& ranger);

}  // namespace troupe::sensors
