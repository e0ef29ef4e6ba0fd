#pragma once

#include "engine/kinds/controller.hpp"
#include "engine/kinds/controller_kind.hpp"

#include <array>
#include <cstdint>

namespace troupe::models {

inline constexpr std::uint32_t k_raster_columns = 40;  ///< columns of the raster, along x
inline constexpr std::uint32_t k_raster_rows = 20;     ///< rows of the raster, along y
/// The memory of the controller `rasterize`: the variables that the controller keeps between two calls. A
/// recording of the run can contain them. The model is the body, or the part of a body, that has the
/// controller.
struct RasterizeMemory {
  /// The cells of the raster. The cell in column c (along the x axis of the model) and row r (along its y
  /// axis) is element r * k_raster_columns + c; column 0 has the least x, row 0 the least y. 1: an outline of
  /// the model crosses or touches the cell; 0: none does. The outlines are the edges of the model's solids
  /// (shapes), seen from above.
  std::array<std::uint8_t, k_raster_columns * k_raster_rows> cells{};
  TROUPE_FIELDS(cells)
};
/// Returns the definition of the controller `rasterize`, which stores a raster image of its model in its
/// memory (RasterizeMemory::cells) from its first call on. The raster covers the bounding box of the outlines
/// of the model, in the frame of the model, with 40 x 20 cells. If the model has no outlines, all cells are
/// 0. Stage's controller prints the raster instead.
engine::ControllerKind rasterize_controller();

}  // namespace troupe::models
