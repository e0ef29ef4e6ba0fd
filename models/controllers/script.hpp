#pragma once

#include "engine/kinds/controller_kind.hpp"

namespace troupe::models {

/// Returns the definition of the controller `script`: a robot drives without sensors. The parameter `law`
/// selects how its speeds are determined. n is the number of calls of the controller so far, the present call
/// included. Divisions of n are integer divisions, and % is the remainder.
///
/// timed  The parameter `legs` is a list of periods with constant speeds. A leg lasts until its time `until`
///        (simulated time, s). After the last leg, the robot stands still. A drive may run only once per
///        period of several ticks (time steps); the speeds then change at the run of the drive that is
///        nearest to `until`.
/// wave   forward 0.2 + 0.1 * ((n / 7) % 3) m/s, turn 0.4 * (((n / 11) % 5) - 2) rad/s
/// line   forward 0.5 m/s
engine::ControllerKind script_controller();

}  // namespace troupe::models
