#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

#include <array>
#include <cstdint>

namespace troupe::models {

/// Three of Stage's examples: of what a model is made of, and of who meddles with its readings.

/// Adds `count` children, boxes of 0.1 m, to its model when a `.world` file is read: standing on it, at poses
/// drawn uniformly within `reach` of its origin in x and y. They follow from the seed and the model's name
/// within its body: bodies written alike are alike. Does nothing while the world runs.
engine::ControllerKind dynamic_controller();

/// Gives the first transducer of its ranger a normal error of 5 % of each reading (`noise_relative`) when a
/// `.world` file is read; Stage's multiplies what was read. In JSON the ranger says so itself. Does nothing
/// while the world runs but have its ranger run.
engine::ControllerKind lasernoise_controller();

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
