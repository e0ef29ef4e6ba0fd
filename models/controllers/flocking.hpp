#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Flocking of robots with a ring of sonars, after Stage's pioneer_flocking: turn towards where the beams to
/// the front and to the sides see room, and while the way is free drive, turning as the nearest marked robot
/// in sight does.
///
/// needs  a ranger with beams ahead and to both sides (of several the first one of eight or more
///        transducers), a fiducial finder; the way ahead is free while the readings within 30 degrees of
///        straight ahead exceed 1 m, those within 50 degrees 0.5 m, and the direction lies less than 0.5 rad
///        off. Of Stage's Pioneer these are sonars 2 to 5, and 1 and 6, of the front eight
engine::ControllerKind pioneer_flocking_controller();

}  // namespace troupe::models
