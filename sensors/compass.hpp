#pragma once

#include "engine/kinds/device_kind.hpp"

#include <cstddef>

namespace troupe::sensors {

/// The fields of a compass's readings, in order. Each comment begins with the type of the field.
enum CompassField : std::size_t {
  k_compass_heading,  ///< f64: heading of the compass's x axis, rad, world frame, in (-pi, pi]
};

/// Returns the implementation of the sensor `compass`, which reads the heading of the compass's x axis in the
/// world frame: 0 along the world's x axis, counter-clockwise positive, rad.
///
/// reads  The reading is heading + declination + noise_stddev * n, wrapped into (-pi, pi]. Here, heading is
///        the true heading of the compass, and n is a standard normal random number, independent for each
///        body and tick (time step). declination and noise_stddev are parameters. The true heading is the sum
///        of three headings: that of the body, that of the joint that carries the compass (if any), and that
///        of the compass relative to the body or joint.
/// draws  Each reading takes one normal random number from the random stream of the sensor, or none if
///        noise_stddev is 0.
engine::DeviceKind compass_kind();

}  // namespace troupe::sensors
