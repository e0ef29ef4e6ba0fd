#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Drives from goal to goal, in the frame of the robot's estimated pose. It goes on to the next goal once the
/// estimate is near the present one. After the last goal it stays there, or starts again.
///
/// To a goal with a time (`at`) or a `speed`, it moves in a straight line and arrives within 1e-6 m; with a
/// time, at the end of the tick in which that time is reached. A command acts in the tick after it is given,
/// so the first motion is that of the second tick. An obstacle in its way stops it like any robot; after
/// that it moves as fast as its drive can until it is on time again, and skips no goal.
engine::ControllerKind waypoints_controller();

}  // namespace troupe::models
