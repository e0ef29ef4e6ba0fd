#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Segregation by the Brazil nut effect: each robot acts as a disc with the parameter `radius`, which it
/// broadcasts by radio. A light attracts the discs, discs repel one another, and random motion shakes them.
/// So they sort themselves by size: small discs end up nearer to the light than large ones.
///
/// aims      The robot aims along the vector a = `taxis` g + `noise` u + p in its own frame. g is the unit
///           vector towards the light. u is a unit vector of random direction, drawn again every `shake`
///           seconds. p is the repulsion: for each robot heard at a range below the sum R of both radii, a
///           vector of length `push` (1 - range / R) that points away from that robot.
/// drives    The forward speed is `speed` times min(|a|, 1) times the cosine of the angle of a, which may be
///           negative. The turn rate is `gain` times this angle.
/// needs     a drive, a light sensor of three directions or more, a radio with a payload of 4 bytes or more
/// source    Gross, Magnenat, Mondada: Segregation in swarms of mobile robots based on the Brazil nut effect,
///           IROS 2009: random walk, taxis, and repulsion between robots that broadcast their sizes
engine::ControllerKind brazil_nut_controller();

}  // namespace troupe::models
