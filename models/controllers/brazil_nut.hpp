#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Segregation by the Brazil nut effect: each robot acts as a disc of its own `radius`, which it broadcasts
/// by radio. Discs that are attracted by a light, repel one another and are shaken sort themselves by size:
/// small discs end up nearer to the light than large ones.
///
/// aims      along `taxis` g + `noise` u + p, robot frame: g is the unit vector towards the light; u is a
///           unit vector of random direction, drawn again every `shake` s; p is the sum, over the robots
///           heard within the sum R of both radii, of `push` (1 - range / R) away from them
/// drives    `speed` times the length of that vector, at most 1, times the cosine of its angle, also
///           backwards; turns at `gain` times the angle
/// needs     a drive, a light sensor of three directions or more, a radio with a payload of 4 bytes or more
/// source    Gross, Magnenat, Mondada: Segregation in swarms of mobile robots based on the Brazil nut effect,
///           IROS 2009: random walk, taxis, and repulsion between robots that broadcast their sizes
engine::ControllerKind brazil_nut_controller();

}  // namespace troupe::models
