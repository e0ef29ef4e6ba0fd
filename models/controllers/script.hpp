#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Open-loop driving. With the law `timed`, the robot drives with given speeds for given times. The other
/// laws compute the speeds from the number n = 1, 2, ... of the decision, with integer division and % for the
/// remainder:
///
/// wave   forward 0.2 + 0.1 * ((n / 7) % 3) m/s, turn 0.4 * (((n / 11) % 5) - 2) rad/s
/// line   forward 0.5 m/s
engine::ControllerKind script_controller();

}  // namespace troupe::models
