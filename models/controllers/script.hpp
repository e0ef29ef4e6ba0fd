#pragma once

#include "engine/kinds/kinds.hpp"

namespace troupe::models {

/// Returns the definition of the controller `script`: open-loop driving. The parameter `law` selects how the
/// speeds are determined. With `timed`, the robot drives with the speeds of each entry of the parameter
/// `legs` until the simulated time of that entry, and stands still after the last entry. If the drive runs
/// only in some simulation steps, at a fixed period, the speeds change in the one of these steps that is
/// nearest to this time. The other laws compute the speeds from n, the number of calls of the controller so
/// far; at the first call, n = 1. Divisions of n are integer divisions, and % is the remainder:
///
/// wave   forward 0.2 + 0.1 * ((n / 7) % 3) m/s, turn 0.4 * (((n / 11) % 5) - 2) rad/s
/// line   forward 0.5 m/s
engine::ControllerKind script_controller();

}  // namespace troupe::models
