#pragma once

#include "engine/kinds/kinds.hpp"
#include "sensors/ranger_beams.hpp"

namespace troupe::sensors {

/// Casts the beams of a ranger (range sensor) with the grid ray engine for all bodies of the batch, which are
/// the bodies that one task of a parallel loop handles, and writes their readings. This engine follows rays
/// through the cells of a grid into which the outlines of bodies and walls are drawn. The world must use the
/// grid ray engine (World::ray_grid() is not null). The readings differ from those of the exact engine by
/// errors of about the size of a cell (docs/sensing.md). The caller must then call add_extras(), which
/// applies beam widths, noise of readings and lower limits.
void cast_grid(const engine::DeviceBatch& batch, const RangerBeams& ranger);

}  // namespace troupe::sensors
