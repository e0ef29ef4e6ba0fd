#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

#include <array>
#include <cstdint>

namespace troupe::models {

inline constexpr std::uint32_t k_raster_columns = 40;  ///< columns of the raster, over the model's size in x
inline constexpr std::uint32_t k_raster_rows = 20;     ///< rows of the raster, over the model's size in y
/// The memory of `rasterize`, which can be recorded.
struct RasterizeMemory {
  std::array<std::uint8_t, k_raster_columns * k_raster_rows> cells{};  ///< 1: an outline; from below, x first
  TROUPE_FIELDS(cells)
};
/// Stores which cells of a raster of 40 x 20 over the model's size its outlines cross, in the first tick.
/// Stage prints the raster; here it is the controller's memory, which can be recorded.
engine::ControllerKind rasterize_controller();

}  // namespace troupe::models
