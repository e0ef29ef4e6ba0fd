#pragma once

#include "engine/kinds/controller_kind.hpp"

namespace troupe::models {

/// Returns the definition of the controller `beeclust`: robots gather on bright ground, although a robot
/// senses only the brightness of the ground below itself and not the direction of brighter ground. When a
/// robot meets another robot, it waits; the brighter the ground below it, the longer it waits.
///
/// Names in backquotes are parameters.
///
/// walks     The robot drives straight on. If its ranger sees an obstacle ahead within `min_front` (m), the
///           robot turns on the spot, away from the nearer side, by a random angle of 90 to 180 degrees.
/// meets     All robots broadcast radio messages. A robot meets another robot if three conditions hold: it
///           receives a message from that robot, their radios are at most `meet` (m) apart, and the other
///           radio is within 60 degrees of straight ahead. A wall sends no message, so robots do not wait at
///           walls.
/// waits     When the robot meets another robot, it stops for `max_wait` S^2 / (S^2 + `half`), in s. S is the
///           brightness (0 to 1) of the ground below the robot when it stops. `max_wait` is in s; `half` is a
///           number without unit. After the wait the robot turns to a random side by 90 to 180 degrees and
///           walks on.
/// LED       If the robot has an LED, the LED is blue while the robot walks and amber while it waits.
/// needs     a drive, a ground sensor, a radio, a ranger with more than 8 beams that sees ahead
/// source    Schmickl, Thenius, Moeslinger, Radspieler, Kernbach, Szymanski, Crailsheim: Get in touch:
///           cooperative decision making based on robot-to-robot collisions, Autonomous Agents and
///           Multi-Agent Systems 18, 2009; the name and the formula of the waiting time: Schmickl, Hamann:
///           BEECLUST: a swarm algorithm derived from honeybees, 2011. In these papers, the robots sense the
///           brightness of light from above, not of the ground
engine::ControllerKind beeclust_controller();

}  // namespace troupe::models
