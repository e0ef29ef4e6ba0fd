#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Flocking of robots with a ring of sonars, after Stage's pioneer_flocking: turn in the direction in which
/// the beams to the front and to the sides see free space, and while the way is free, drive, turning like
/// the nearest marked robot in sight.
///
/// needs  a ranger with beams ahead and to both sides (the first one with eight or more transducers, else the
///        first one), and a fiducial finder
/// free   the way is free while the readings within 30 degrees of straight ahead exceed 1 m, those within 50
///        degrees exceed 0.5 m, and the direction of free space is less than 0.5 rad off straight ahead. On
///        Stage's Pioneer these are sonars 2 to 5, and 1 and 6, of the front eight
engine::ControllerKind pioneer_flocking_controller();

}  // namespace troupe::models
