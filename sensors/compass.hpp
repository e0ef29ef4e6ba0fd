#pragma once

#include "engine/kinds/kinds.hpp"

#include <cstddef>

namespace troupe::sensors {

/// The fields of a compass's readings, in order.
enum CompassField : std::size_t {
  k_compass_heading,  ///< f64: heading of the compass's x axis, rad, world frame, in (-pi, pi]
};

/// Returns the sensor kind `compass`, which reads the heading of the compass's x axis in the world frame: 0
/// along the world's x axis, counter-clockwise positive, rad.
///
/// reads  The reading is heading + declination + noise_stddev * n, wrapped into (-pi, pi]. heading is the
///        true heading of the compass; declination and noise_stddev are parameters. The number n is standard
///        normal, independent for each body and tick. The heading of a compass includes the heading of its
///        pose and of the joint that carries it.
/// draws  It draws one normal random number per body and reading from the sensor's random stream; none if
///        noise_stddev is 0.
engine::DeviceKind compass_kind();

}  // namespace troupe::sensors
