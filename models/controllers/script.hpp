#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Open-loop driving: timed speeds, or a law of the number n = 1, 2, ... of the decision (integer division):
///
/// wave   forward 0.2 + 0.1 * ((n / 7) % 3) m/s, turn 0.4 * (((n / 11) % 5) - 2) rad/s
/// line   forward 0.5 m/s
engine::ControllerKind script_controller();

}  // namespace troupe::models
