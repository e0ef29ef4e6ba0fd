#pragma once

#include "engine/spec/body_type.hpp"
#include "engine/spec/world_spec.hpp"
#include "partition/sparse_grid.hpp"

#include <span>

namespace troupe::engine {

/// Chooses the cells of the spatial index. Their least width is an eighth of the mean reach of the bodies
/// with rows. The reach of a body is the longest reach of its active devices
/// (DeviceKind::Prepared::cell_hint_m, or reach_m if that is not set) plus its radius; without such devices,
/// it counts as 16 radii. Such cells are small enough to exclude most bodies out of reach. The mean is used,
/// not the maximum, so that a few robots of long range do not coarsen the grid. Where few bodies would share
/// a block of such cells, the cells are wider, so that a query visits fewer of them. No result depends on the
/// choice.
///
/// types: the compiled types of `spec`
/// tile_size_m: width of the tiles, m; 0: chosen. The tiles are divided into cells of about the width above.
/// Wide bodies may require wider tiles. Tiles that would make the cells much wider are made narrower, and
/// tiles with very many cells are divided into wider cells.
partition::GridGeometry choose_grid(const WorldSpec& spec, std::span<const BodyType> types,
                                    double tile_size_m);

}  // namespace troupe::engine
