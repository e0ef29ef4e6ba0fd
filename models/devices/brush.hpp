#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// What controllers ask of a brush; it paints in every tick until they ask otherwise.
struct BrushCommand {
  std::uint8_t paints = 0;  ///< 1: in each tick
  float red = 0;            ///< each from 0 to 1
  float green = 0;          ///< 0 to 1
  float blue = 0;           ///< 0 to 1
  TROUPE_FIELDS(paints, red, green, blue)

  /// With this colour, each part 0 to 1.
  void paint(float r, float g, float b) { *this = {1, r, g, b}; }
};

/// What a brush has done.
struct BrushState {
  std::uint64_t painted = 0;  ///< zones that it has given a colour that they did not have
  TROUPE_FIELDS(painted)
};

/// A brush: gives the zone below it a colour, if that zone carries an LED. Of several that paint one zone in
/// a tick the one with the highest id has it in the end.
engine::DeviceKind brush_kind();

}  // namespace troupe::models
