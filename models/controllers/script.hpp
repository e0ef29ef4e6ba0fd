#pragma once

#include "engine/kinds/kinds.hpp"

namespace troupe::models {

/// Open-loop driving by the parameter `law`. With `timed`, the robot drives with the speeds of each entry of
/// the parameter `legs` until the world time of that entry, and stands still after the last entry. If the
/// drive has a period, the speeds change at the run of the drive that is nearest to this time. The other laws
/// compute the speeds from n, the number of calls of the controller so far; at the first call, n = 1.
/// Divisions of n are integer divisions, and % is the remainder:
///
/// wave   forward 0.2 + 0.1 * ((n / 7) % 3) m/s, turn 0.4 * (((n / 11) % 5) - 2) rad/s
/// line   forward 0.5 m/s
engine::ControllerKind script_controller();

}  // namespace troupe::models
