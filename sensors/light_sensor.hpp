#pragma once

#include "engine/kinds.hpp"

#include <cstddef>

namespace troupe::sensors {

/// Fields of a light sensor's percepts, in their order.
enum LightSensorField : std::size_t {
  k_light_brightness,  ///< f32 for each direction
  k_light_sources,     ///< u32: lights that it sees
};

/// A ring of light sensors: how bright it is, by direction.
///
/// reads  of direction k, which looks along heading 2 pi k / directions in the sensor's frame: the sum over
///        all lights in sight of intensity * max(0, cos a) / d^2, with d (m) the distance, also in height,
///        and a the angle between the direction and the way to the light
/// sight  lights (`blinkenlight`, `lightindicator`, sensors/light_source.hpp) of other bodies that are lit,
/// no
///        farther than range_max on the ground; with `occlusion` those alone that nothing stands before, at
///        the sensor's height. A light's own body never does
/// order  sums are made in the order of (body, device), in double
/// edges  a light straight above adds nothing to any direction, nor does one in the same place
engine::DeviceKind light_sensor_kind();

}  // namespace troupe::sensors
