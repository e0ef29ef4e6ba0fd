#pragma once

#include "engine/kinds.hpp"

#include <cstddef>

namespace troupe::sensors {

/// Fields of a compass's percepts, in their order.
enum CompassField : std::size_t {
  k_compass_heading,  ///< f64: heading of the compass's x axis, rad, world frame, in (-pi, pi]
};

/// Reads the heading of its own x axis in the world frame: 0 along the world's x axis, counter-clockwise
/// positive.
///
/// reads  heading of the compass + declination + noise_stddev * n, wrapped into (-pi, pi]; n is standard
/// normal and
///        independent for each body and tick. A compass that is mounted with a turn, or stands on a joint,
///        reads its own heading, not its robot's
/// draws  one normal a body and tick from the sensor's stream; none where noise_stddev is 0
engine::DeviceKind compass_kind();

}  // namespace troupe::sensors
