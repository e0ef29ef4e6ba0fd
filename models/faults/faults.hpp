#pragma once

#include "engine/kinds/fault_kind.hpp"

namespace troupe::models {

/// Returns the definition of the fault `dead_sensors`: sensors stop working and repeat their last readings.
/// The parameter `sensors` names the sensors; if it is empty, all sensors of the robot stop working.
/// Controllers cannot distinguish repeated readings from new ones.
engine::FaultKind dead_sensors_fault();

/// Returns the definition of the fault `slow_wheels`: the drive of a robot is slower than commanded. All
/// velocities of the drive are multiplied by the parameter `factor`, which is above 0 and at most 1. The
/// wheels measure the slower motion, so the fault adds no odometry error.
engine::FaultKind slow_wheels_fault();

/// Returns the definition of the fault `drop_out`: the drive, the devices and the controllers of a robot all
/// stop at a random time. The parameter `for` (s) is the duration of a stop. After this time the robot works
/// again, until its next stop. With `for` = 0, the robot never works again.
///
/// The time until a stop is exponentially distributed with the mean 1 / `rate`; the parameter `rate` (1/s) is
/// above 0. For the first stop, the time counts from the start of the fault (the key `from` in the world
/// file). For any later stop, it counts from the end of the previous stop.
engine::FaultKind drop_out_fault();

}  // namespace troupe::models
