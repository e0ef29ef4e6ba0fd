#pragma once

#include "engine/kinds/device_kind.hpp"

#include <cstddef>

namespace troupe::sensors {

/// The fields of a light sensor's readings, in order. Each comment begins with the type of the field.
enum LightSensorField : std::size_t {
  k_light_brightness,  ///< f32 per direction: brightness (no unit), 0 without light, see light_sensor_kind()
  k_light_sources,     ///< u32: number of lights in sight
};

/// Returns the implementation of the sensor `light_sensor`, a ring of light sensors that reads the brightness
/// in several directions. A light is a device of the kind `blinkenlight` or `lightindicator`
/// (sensors/light_source.hpp). Words in backquotes are parameters of the sensor.
///
/// reads  Direction k, counted from 0, has the heading 2 pi k / `directions` in the sensor frame. The
///        brightness in a direction is the sum of intensity * max(0, cos a) / d^2 over all lights in sight.
///        Here, intensity is a parameter of the light (no unit), d is the distance to the light (m, including
///        the difference in height), and a is the angle between the direction and the line to the light.
/// sight  A light is in sight if it is lit, nothing hides it, and its horizontal distance is at most
///        `range_max` (m). Lights on the sensor's own body are ignored, and so are lights on bodies that move
///        together with it (one of the two carries the other, or a third body carries both).
/// hides  If `occlusion` is true, walls and bodies hide lights. The sensor casts a horizontal ray towards the
///        light, at its own height, up to the horizontal distance of the light. A wall or body that this ray
///        hits hides the light. The body of the sensor and the body of the light never hide the light.
///        Neither do bodies that move together with one of these two.
/// order  Brightnesses are summed in double precision, in the order of body ids. For one body, the lights are
///        added in the order of its devices.
/// edges  A light straight above or below the sensor, or at the same place, is counted as a light in sight,
///        but adds nothing to the brightness in any direction.
engine::DeviceKind light_sensor_kind();

}  // namespace troupe::sensors
