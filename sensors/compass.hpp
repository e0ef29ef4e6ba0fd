#pragma once

#include "engine/kinds/kinds.hpp"

#include <cstddef>

namespace troupe::sensors {

/// The fields of a compass's readings, in order. Each comment begins with the type of the field.
enum CompassField : std::size_t {
  k_compass_heading,  ///< f64: heading of the compass's x axis, rad, world frame, in (-pi, pi]
};

/// Returns the implementation of the sensor `compass`, which reads the heading of the compass's x axis in the
/// world frame: 0 along the world's x axis, counter-clockwise positive, rad.
///
/// reads  The reading is heading + declination + noise_stddev * n, wrapped into (-pi, pi]. heading is the
///        true heading of the compass; declination and noise_stddev are parameters. The number n is standard
///        normal, independent for each body and tick (time step). The true heading is the sum of the headings
///        of the body, of the joint that carries the compass (if any), and of the pose of the compass on the
///        body or joint.
/// draws  Each reading takes one normal random number from the random stream of the sensor; none if
///        noise_stddev is 0.
engine::DeviceKind compass_kind();

}  // namespace troupe::sensors
