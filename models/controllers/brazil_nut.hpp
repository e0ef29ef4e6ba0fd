#pragma once

#include "engine/kinds/controller_kind.hpp"

namespace troupe::models {

/// Returns the definition of the controller `brazil_nut`: robots sort themselves by size, by the Brazil nut
/// effect. Each robot acts as a disc, whose radius is the parameter `radius` (m), and broadcasts this radius
/// by radio. A light attracts the discs, discs repel one another, and random motion shakes them. As a result,
/// small discs end up nearer to the light than large ones.
///
/// Names in backquotes are parameters.
///
/// aims      The robot steers along the vector a = `taxis` g + `noise` u + p, in its own frame.
///           g  unit vector towards the light; 0 if the light sensor sees no light. It has the direction of
///              the sum of the sensor's directions, each times its brightness. With an even number of
///              directions, this is exactly the direction of a single light. With an odd number it is not:
///              with three directions it is up to 30 degrees off
///           u  unit vector of random direction, which changes every `shake` seconds
///           p  sum of the repulsions by all robots that the robot hears. Let R be the sum of the radii of
///              the robot and of one other robot, and r the distance between their radios. If r is below R,
///              the repulsion by the other robot is a vector of length `push` (1 - r / R) that points away
///              from that robot. Otherwise it is 0.
/// drives    The forward speed is `speed` times min(|a|, 1) times cos(b), where b is the angle from straight
///           ahead to a. So the robot drives backwards if a points backwards. The turn rate is `gain` times
///           b.
/// needs     a drive, a light sensor that measures in three directions or more, a radio with a payload of 4
///           bytes or more
/// source    Gross, Magnenat, Mondada: Segregation in swarms of mobile robots based on the Brazil nut effect,
///           IROS 2009: random walk, taxis, and repulsion between robots that broadcast their sizes
engine::ControllerKind brazil_nut_controller();

}  // namespace troupe::models
