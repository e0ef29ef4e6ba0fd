#pragma once

#include "engine/kinds/kinds.hpp"

namespace troupe::models {

/// Aggregation on bright ground. A robot senses the brightness of the ground only below itself, not the
/// direction of brighter ground. A robot that meets another robot waits there, and it waits longer on
/// brighter ground.
///
/// walks     The robot drives straight on. If its ranger sees an obstacle ahead that is nearer than the
///           parameter `min_front` (m), it turns on the spot by a random angle (90 to 180 degrees), away from
///           the nearer side.
/// meets     The robot meets another robot if it receives a message of that robot, the two radios are at most
///           the parameter `meet` (m) apart, and the other radio is within 60 degrees of straight ahead. A
///           wall sends no message, so the robot turns away from a wall without waiting.
/// waits     When it meets another robot, it stops for `max_wait` S^2 / (S^2 + `half`) seconds, where
///           `max_wait` (s) and `half` are parameters and S is the brightness, 0 to 1, of the ground below
///           the robot when it stops. Then it turns to a random side by 90 to 180 degrees and walks on.
/// LED       If the robot has an LED, the LED is blue while the robot walks and amber while the robot waits.
/// needs     a drive, a ground sensor, a radio, a ranger with more than 8 beams that sees ahead
/// source    Schmickl, Thenius, Moeslinger, Radspieler, Kernbach, Szymanski, Crailsheim: Get in touch:
///           cooperative decision making based on robot-to-robot collisions, Autonomous Agents and
///           Multi-Agent Systems 18, 2009; the name and the law of waiting: Schmickl, Hamann: BEECLUST: a
///           swarm algorithm derived from honeybees, 2011. In these papers the cue is light from above
engine::ControllerKind beeclust_controller();

}  // namespace troupe::models
