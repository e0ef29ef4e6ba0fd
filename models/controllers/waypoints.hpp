#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Drives from goal to goal, in the frame of the robot's estimated pose. The robot goes on to the next goal
/// once its estimated pose is near the present goal. At the last goal it stays, or starts again with the
/// first.
///
/// To a goal with a time (`at`) or a `speed`, the robot moves in a straight line and arrives within 1e-6 m.
/// It arrives at a goal with a time at the end of the tick in which that time is reached. A command acts in
/// the tick after the one in which it is given, so the robot first moves in the second tick. An obstacle in
/// its way stops it like any robot. Then it moves as fast as its drive can until it is on time again, and
/// skips no goal.
engine::ControllerKind waypoints_controller();

}  // namespace troupe::models
