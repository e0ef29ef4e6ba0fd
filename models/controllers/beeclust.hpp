#pragma once

#include "engine/kinds/kinds.hpp"

namespace troupe::models {

/// Returns the definition of the controller `beeclust`: aggregation on bright ground. A robot senses the
/// brightness of the ground only below itself, not the direction of brighter ground. A robot that meets
/// another robot waits there, and it waits longer on brighter ground.
///
/// walks     The robot drives straight on. If its ranger sees an obstacle ahead within `min_front` (m, a
///           parameter), the robot turns on the spot, away from the nearer side, by a random angle of 90 to
///           180 degrees.
/// meets     The robot meets another robot if three conditions hold: it receives a message from that robot,
///           the radios are at most `meet` (m, a parameter) apart, and the other radio is within 60 degrees
///           of straight ahead. A wall sends no message, so the robot turns away from a wall without waiting.
/// waits     When the robot meets another robot, it stops for `max_wait` S^2 / (S^2 + `half`) seconds.
///           `max_wait` (s) and `half` are parameters, and S is the brightness (0 to 1) of the ground below
///           the robot at that time. Then the robot turns to a random side by 90 to 180 degrees and walks on.
/// LED       If the robot has an LED, the LED is blue while the robot walks and amber while the robot waits.
/// needs     a drive, a ground sensor, a radio, a ranger with more than 8 beams that sees ahead
/// source    Schmickl, Thenius, Moeslinger, Radspieler, Kernbach, Szymanski, Crailsheim: Get in touch:
///           cooperative decision making based on robot-to-robot collisions, Autonomous Agents and
///           Multi-Agent Systems 18, 2009; the name and the formula of the waiting time: Schmickl, Hamann:
///           BEECLUST: a swarm algorithm derived from honeybees, 2011. In these papers, the robots sense the
///           brightness of light from above, not of the ground
engine::ControllerKind beeclust_controller();

}  // namespace troupe::models
