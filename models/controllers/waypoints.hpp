#pragma once

#include "engine/kinds/controller_kind.hpp"

namespace troupe::models {

/// Returns the definition of the controller `waypoints`: a robot drives from goal to goal. A goal is a pose
/// in the frame in which the robot estimates its own pose. After the last goal, the robot stays there; if the
/// parameter `again` is true, it starts again with the first goal. Before it leaves a goal, it waits there
/// for the time `wait` (s) of the goal. A tick is a time step. There are two sorts of goals.
///
/// plain  A goal without a time (`at`) and without a `speed`. The drive determines the path and the speed.
///        The goal is reached when the estimated position of the robot is within the parameter `near` (m) of
///        it; the heading does not matter.
/// exact  A goal with a time (`at`, s) or a `speed` (m/s). It needs a drive of the kind `omni`. If the
///        controller commands a device `wheels`, this device must have this drive, and must run once per
///        decision. The robot moves to the goal in a straight line, and reaches it within 1e-6 m and 1e-6
///        rad. If the goal has a time, the robot arrives at the end of the tick in which this time is
///        reached. Times count from the start of the run or, with `again`, from the start of the present
///        round.
/// delay  A command takes effect one tick after the controller has given it, so a robot first moves in the
///        second tick. A drive may also run only once per period of several ticks. A command then takes
///        effect one period later, and the robot arrives at the end of a period, at the latest at the time of
///        the goal.
/// late   Other bodies and walls block the robot as usual. If this makes the robot late for an exact goal, it
///        moves as fast as its drive can until it is on time. It skips no goal.
engine::ControllerKind waypoints_controller();

}  // namespace troupe::models
