#pragma once

#include "engine/kinds/kinds.hpp"

#include <cstddef>

namespace troupe::sensors {

/// The fields of a light sensor's readings, in order. Each comment begins with the type of the field.
enum LightSensorField : std::size_t {
  k_light_brightness,  ///< f32 per direction: brightness (no unit), 0 without light, see light_sensor_kind()
  k_light_sources,     ///< u32: number of lights in sight
};

/// Returns the implementation of the sensor `light_sensor`, a ring of light sensors that reads the brightness
/// in several directions. A light is a device of the kind `blinkenlight` or `lightindicator`
/// (sensors/light_source.hpp).
///
/// reads  Direction k has the heading 2 pi k / `directions` (a parameter) in the sensor frame. Its reading is
///        the sum over all lights in sight of intensity * max(0, cos a) / d^2. Here, intensity (no unit) is a
///        parameter of the light, d (m) is the distance to the light, including height, and a is the angle
///        between the direction and the line to the light.
/// sight  A light is in sight if it is lit, its horizontal distance is at most range_max (a parameter, m),
///        and nothing hides it. Lights on the sensor's own body, and on bodies that move with this body (one
///        carries the other, or a third body carries both), are ignored. With the parameter `occlusion`, a
///        light is hidden by any body or wall that the horizontal line from the sensor towards the light
///        meets at the height of the sensor. The sensor's body, the body of the light, and bodies that move
///        with one of these two bodies, never hide the light.
/// order  Sums are computed in the order of body ids, then of the devices of a body, in double precision.
/// edges  A light straight above or below the sensor, or at the same place, adds nothing to any direction,
///        but counts as a light in sight.
engine::DeviceKind light_sensor_kind();

}  // namespace troupe::sensors
