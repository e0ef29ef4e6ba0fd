#pragma once

#include "engine/kinds/device_batch.hpp"
#include "sensors/ranger_beams.hpp"

namespace troupe::sensors {

/// Casts the beams of a ranger (range sensor) with the grid ray engine, and writes the readings. The grid
/// engine follows rays through the cells of a grid into which the outlines of bodies and walls are drawn. The
/// readings differ from those of the exact engine by about the size of a cell (docs/sensing.md). The world
/// must use the grid engine: SensingView::ray_grid() must not be null. batch: the bodies whose rangers are
/// computed. After this function, the caller must call add_extras(), which applies beam widths, noise of
/// readings and lower limits.
void cast_grid(const engine::DeviceBatch& batch, const RangerBeams& ranger);

}  // namespace troupe::sensors
