#pragma once

#include "engine/kinds/kinds.hpp"

namespace troupe::models {

/// Returns the definition of the controller `pioneer_flocking`: flocking of robots with a ring of sonars, as
/// in Stage's example of the same name. A robot turns towards free space. The direction of free space is that
/// of the sum of vectors along the beams to the front and to the sides; the length of each vector is the
/// reading of its beam. While the way is free, the robot also drives, and turns to the heading of the nearest
/// robot that its fiducial finder reports.
///
/// needs  a ranger with beams ahead and to both sides, and a fiducial finder. The controller uses the first
///        ranger of this form with eight or more transducers (fans of beams). If there is none, it uses the
///        first ranger of this form
/// free   The way is free while three conditions hold. All readings within 30 degrees of straight ahead
///        exceed 1 m; on Stage's Pioneer, these are the sonars 2 to 5, counted from 0. All readings between
///        30 and 50 degrees exceed 0.5 m; these are the sonars 1 and 6. The direction of free space is less
///        than 0.5 rad from straight ahead. While the way is not free, the robot turns on the spot towards
///        the free space. If it would turn at less than 0.1 rad/s to either side, it turns left at a random
///        rate below 1 rad/s instead.
engine::ControllerKind pioneer_flocking_controller();

}  // namespace troupe::models
