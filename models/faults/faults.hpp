#pragma once

#include "engine/kinds/fault_kind.hpp"

namespace troupe::models {

/// Sensors that stop working: they repeat their last readings. The parameter `sensors` names the sensors; if
/// it is empty, all sensors of the robot fail. Controllers cannot distinguish repeated readings from new
/// ones.
engine::FaultKind dead_sensors_fault();

/// A drive that is slower than commanded: all its velocities are multiplied by the parameter `factor`, above
/// 0 and at most 1. Odometry measures the slower motion, so the fault adds no odometry error.
engine::FaultKind slow_wheels_fault();

/// A robot whose devices, controllers and drive all stop at a random time. The time from the start of the
/// fault (the key `from` in the world file) to the first failure is exponentially distributed; the parameter
/// `rate` (1/s) is the inverse of its mean. With the parameter `for` (s) above 0, each failure lasts `for`
/// seconds, and the robot then works until its next failure. With 0, the failure is permanent.
engine::FaultKind drop_out_fault();

}  // namespace troupe::models
