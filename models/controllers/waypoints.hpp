#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Goes from goal to goal, each in the frame of the robot's estimate; the next one once the estimate is
/// near the last. After the last it stays there, or begins again.
///
/// A goal with a time (`at`) or a `speed` it goes to in a straight line, and is there to 1e-6 m; with a time
/// in so long that it is there when the tick ends with which that time is reached. Its command acts a tick
/// after it is given, so that the first motion is that of the second tick. What stands in its way stops it,
/// as any robot; then it goes on as fast as its drive can until it is in time again, and leaves out no goal.
engine::ControllerKind waypoints_controller();

}  // namespace troupe::models
