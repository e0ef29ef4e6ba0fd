#pragma once

#include "engine/kinds/kinds.hpp"

namespace troupe::models {

/// Returns the definition of the controller `waypoints`: a robot drives from goal to goal. Goals are poses in
/// the frame in which the robot estimates its own pose. The robot has reached a goal once its estimated
/// position is within the parameter `near` (m) of the goal, whatever its heading. It waits there for the time
/// `wait` (s) of the goal, and goes on to the next goal. After the last goal, it starts again with the first
/// goal if the parameter `again` is true; else it stays.
///
/// To a goal with a time (`at`) or a `speed`, the robot moves in a straight line, and it arrives within 1e-6
/// m and 1e-6 rad of the goal; `near` does not apply. Such goals need a drive of kind `omni`. If the goal has
/// a time, the robot arrives at the end of the tick (simulation step) in which this time is reached. A
/// command acts one tick after the controller has given it, so the robot first moves in the second tick. If
/// the drive runs only once per period of several ticks, a command acts one period after the controller has
/// given it, and the robot arrives at the end of a period: the last period that is over by the time of the
/// goal. An obstacle in its way blocks the robot, as it blocks robots with other controllers. Once the way is
/// free again, the robot moves as fast as its drive can until it is on time. It skips no goal.
engine::ControllerKind waypoints_controller();

}  // namespace troupe::models
