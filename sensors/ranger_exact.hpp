#pragma once

#include "engine/kinds/kinds.hpp"
#include "sensors/ranger_beams.hpp"

namespace troupe::sensors {

/// Casts the beams of a ranger (range sensor) with the exact ray engine for all bodies of the batch, which
/// are the bodies that one task of a parallel loop handles, and writes their readings. This engine intersects
/// beams with the outlines of bodies and walls. The caller must then call add_extras(), which applies beam
/// widths, noise of readings and lower limits.
void cast_exact(const engine::DeviceBatch& batch, const RangerBeams& ranger);

}  // namespace troupe::sensors
