#pragma once

#include "engine/kinds/device_batch.hpp"
#include "sensors/ranger_beams.hpp"

namespace troupe::sensors {

/// Casts the beams of a ranger (range sensor) with the exact ray engine, and writes the readings. The exact
/// engine intersects beams with the outlines of bodies and walls. batch: the bodies whose rangers are
/// computed. After this function, the caller must call add_extras(), which applies beam widths, noise of
/// readings and lower limits.
void cast_exact(const engine::DeviceBatch& batch, const RangerBeams& ranger);

}  // namespace troupe::sensors
