#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Segregation by the Brazil nut effect: each robot acts as a disc of its own `radius`, and says by radio how
/// large that is. Drawn to a light, pushed by one another and shaken, small discs get below large ones.
///
/// goes      along t g + n u + p, robot frame: g is the unit vector towards the light, u a unit vector of any
///           direction, drawn again every `shake` s, p the sum over those heard that are nearer than both
///           radii together of `push` (1 - range / both radii) away from them
/// drives    `speed` times the length of that, at most 1, times the cosine of its angle, backwards too; and
///           turns by `gain` times the angle to it
/// needs     a drive, a light sensor of three directions or more, a radio with a payload of 4 bytes or more
/// source    Gross, Magnenat, Mondada: Segregation in swarms of mobile robots based on the Brazil nut effect,
///           IROS 2009: random walk, taxis, and repulsion by others whose size they tell
engine::ControllerKind brazil_nut_controller();

}  // namespace troupe::models
