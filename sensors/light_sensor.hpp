#pragma once

#include "engine/kinds.hpp"

#include <cstddef>

namespace troupe::sensors {

/// The fields of a light sensor's percepts, in order.
enum LightSensorField : std::size_t {
  k_light_brightness,  ///< f32 per direction
  k_light_sources,     ///< u32: number of lights in sight
};

/// A ring of light sensors: reads brightness by direction.
///
/// reads  Direction k looks along heading 2 pi k / directions in the sensor frame. It reads the sum over all
///        lights in sight of intensity * max(0, cos a) / d^2, where d (m) is the distance, including height,
///        and a the angle between the direction and the line to the light
/// sight  Lit lights (`blinkenlight`, `lightindicator`, sensors/light_source.hpp) of other bodies within
///        range_max on the ground; with `occlusion` only those that no body hides at the height of the
///        sensor. A light's own body never hides it
/// order  sums are computed in the order of (body, device), in double
/// edges  a light straight above, or at the same place, adds nothing to any direction
engine::DeviceKind light_sensor_kind();

}  // namespace troupe::sensors
