#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Flocking of robots with a ring of sonars, after Stage's pioneer_flocking: turn towards where the first
/// eight sonars see room, and while the way is free drive, turning as the nearest marked robot in sight does.
///
/// needs  a ranger of eight or more transducers, a fiducial finder; the way ahead is free while r2 to r5
///        exceed 1 m, r1 and r6 0.5 m and the direction lies less than 0.5 rad off
engine::ControllerKind pioneer_flocking_controller();

}  // namespace troupe::models
