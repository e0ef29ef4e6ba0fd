#pragma once

#include "engine/kinds/kinds.hpp"
#include "sensors/ranger_beams.hpp"

namespace troupe::sensors {

/// Casts the beams of a ranger with the grid ray engine for all bodies of the batch, and writes their
/// readings. The world must have this engine (World::ray_grid()). The readings differ from those of the exact
/// engine by errors of about the size of a cell (docs/sensing.md). The caller must then call add_extras(),
/// which applies beam widths, noise of readings and lower limits.
void cast_grid(const engine::DeviceBatch& batch, const RangerBeams& ranger);

}  // namespace troupe::sensors
