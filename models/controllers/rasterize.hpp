#pragma once

#include "engine/kinds/controller.hpp"
#include "engine/kinds/kinds.hpp"

#include <array>
#include <cstdint>

namespace troupe::models {

inline constexpr std::uint32_t k_raster_columns = 40;  ///< columns of the raster, along x
inline constexpr std::uint32_t k_raster_rows = 20;     ///< rows of the raster, along y
/// The memory of the controller `rasterize`: the variables that the controller keeps between calls. A
/// recording of the run can contain them.
struct RasterizeMemory {
  /// The cells of the raster, row by row: rows in order of y, and cells of a row in order of x. x and y are
  /// the axes of the model (the body, or part of a body, that has the controller). 1: an outline (edges of a
  /// solid of the model, seen from above) crosses or touches the cell; 0: none does.
  std::array<std::uint8_t, k_raster_columns * k_raster_rows> cells{};
  TROUPE_FIELDS(cells)
};
/// Returns the definition of the controller `rasterize`. From its first call on, the controller has a raster
/// of 40 x 20 cells in its memory (RasterizeMemory). The raster covers the bounding box of the outlines of
/// the model that has the controller, in the frame of this model. If the model has no outlines, all cells are
/// 0. Stage's controller prints the raster; here a recording can contain it.
engine::ControllerKind rasterize_controller();

}  // namespace troupe::models
