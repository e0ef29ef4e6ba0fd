#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Flocking of robots with a ring of sonars, as in Stage's pioneer_flocking. A robot turns in the direction
/// in which its beams to the front and to the sides see free space, that is, along the vector sum of these
/// beams. While the way is free, it also drives, and turns to the heading of the nearest marked robot in
/// sight.
///
/// needs  a ranger with beams ahead and to both sides, and a fiducial finder. It takes the first such ranger
///        with eight or more transducers, or, if there is none, the first such ranger
/// free   The way is free while three conditions hold. The readings within 30 degrees of straight ahead
///        exceed 1 m: on Stage's Pioneer, sonars 2 to 5 of the front eight. The readings within 50 degrees
///        exceed 0.5 m: sonars 1 and 6. The direction of free space is less than 0.5 rad off straight ahead.
engine::ControllerKind pioneer_flocking_controller();

}  // namespace troupe::models
