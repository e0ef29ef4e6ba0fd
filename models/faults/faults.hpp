#pragma once

#include "engine/kinds/fault_kind.hpp"

namespace troupe::models {

/// Returns the definition of the fault `dead_sensors`: sensors stop working and repeat their last readings.
/// The parameter `sensors` names the sensors; if it is empty, all sensors of the robot fail. Controllers
/// cannot distinguish repeated readings from new ones.
engine::FaultKind dead_sensors_fault();

/// Returns the definition of the fault `slow_wheels`: a drive is slower than commanded. All its velocities
/// are multiplied by the parameter `factor`, above 0 and at most 1. Odometry (the motion that the wheels
/// measure) contains the slower motion, so the fault adds no odometry error.
engine::FaultKind slow_wheels_fault();

/// Returns the definition of the fault `drop_out`: the devices, controllers and drive of a robot all stop at
/// a random time. The time from the start of the fault (the key `from` in the world file) to the first
/// failure is exponentially distributed; the parameter `rate` (1/s) is the inverse of its mean. With the
/// parameter `for` (s) above 0, each failure lasts `for` seconds, and the robot then works until its next
/// failure. With 0, the failure is permanent.
engine::FaultKind drop_out_fault();

}  // namespace troupe::models
