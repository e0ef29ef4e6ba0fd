#pragma once

#include "engine/kinds/controller_kind.hpp"

namespace troupe::models {

/// Returns the definition of the controller `pioneer_flocking`: flocking of robots with a ring of sonars.
/// Stage has an example of the same name.
///
/// aims    Each beam that points forwards or sideways gives a vector along the beam whose length is the
///         reading of the beam. The sum of these vectors points to free space.
/// drives  While the way is free, the robot drives, and turns towards the free space and to the heading of
///         the nearest robot that its fiducial finder (a sensor that detects marked objects) reports.
/// turns   While the way is not free, the robot turns on the spot towards the free space. If this turn would
///         be slower than 0.1 rad/s, the robot turns left instead, at a random rate below 1 rad/s.
/// free    The way is free if three conditions hold:
///         - All readings within 30 degrees of straight ahead exceed 1 m. On Stage's Pioneer, these are the
///           sonars 2 to 5, counted from 0.
///         - All readings between 30 and 50 degrees exceed 0.5 m. On the Pioneer, these are the sonars 1 and
///           6.
///         - The direction of free space is less than 0.5 rad from straight ahead.
/// needs   a drive; a fiducial finder; a ranger with a beam within 30 degrees of straight ahead, a beam to
///         the left and a beam to the right. Of several such rangers, the controller uses the first that has
///         eight or more transducers (fans of beams) or, if none has so many, the first
engine::ControllerKind pioneer_flocking_controller();

}  // namespace troupe::models
