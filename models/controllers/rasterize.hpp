#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

#include <array>
#include <cstdint>

namespace troupe::models {

inline constexpr std::uint32_t k_raster_columns = 40;  ///< of `rasterize`, over the model's size in x
inline constexpr std::uint32_t k_raster_rows = 20;     ///< of `rasterize`, over the model's size in y
/// The memory of `rasterize`, which recordings have as a field.
struct RasterizeMemory {
  std::array<std::uint8_t, k_raster_columns * k_raster_rows> cells{};  ///< 1: an outline; from below, x first
  TROUPE_FIELDS(cells)
};
/// Works out, in the first tick, which cells of a raster of 40 x 20 over the model's size its outlines go
/// through. Nothing is printed, as in Stage: the raster is the controller's memory, and so can be recorded.
engine::ControllerKind rasterize_controller();

}  // namespace troupe::models
