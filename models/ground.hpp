#pragma once

#include "engine/controller.hpp"
#include "engine/kinds.hpp"

#include <cstddef>
#include <cstdint>

namespace troupe::models {

/// Fields of a ground sensor's percepts, in their order.
enum GroundField : std::size_t {
  k_ground_color,  ///< f32 [red green blue] for each point, from 0 to 1
  k_ground_body,   ///< u32 for each point: BodyId of what has this colour; 0: the floor
};

/// A ground sensor: the colours below given points of its robot. The ground is what lies flat on the floor:
/// of the parts of other bodies that hold the point and whose top is no higher than `height`, the one with
/// the highest top, of equal ones that of the lower (body, part); where there is none, the floor.
///
/// zones  are models of the world, with `"obstacle": false` and `"ranger_return": -1` and a size of some
///        millimetres in z; the colour of one that carries an LED is that of the LED
/// edges  of two zones that share a border a point on it lies in one
engine::DeviceKind ground_kind();

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
