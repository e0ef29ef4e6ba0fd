#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Aggregation at a cue, the brightness of the ground. Robots do not sense the direction of the cue: a robot
/// that meets another robot waits there, the longer the brighter the ground is.
///
/// walks     The robot drives straight on. It turns by a random angle away from obstacles nearer than
///           `min_front`.
/// meets     It meets a robot whose radio it hears from at most `meet` away and within 60 degrees of straight
///           ahead. A wall sends no message, so the robot only turns away from it.
/// waits     On a meeting it stops for `max_wait` S^2 / (S^2 + `half`) seconds, where S is the brightness of
///           the ground below it, 0 to 1, read when it stops. Then it turns by 90 to 180 degrees and walks
///           on.
/// LED       If the robot has an LED, it is blue while the robot walks, amber while it waits.
/// needs     a drive, a ground sensor, a radio, a scanner of more than 8 beams
/// source    Schmickl, Thenius, Moeslinger, Radspieler, Kernbach, Szymanski, Crailsheim: Get in touch:
///           cooperative decision making based on robot-to-robot collisions, Autonomous Agents and
///           Multi-Agent Systems 18, 2009; the name and the law of waiting: Schmickl, Hamann: BEECLUST: a
///           swarm algorithm derived from honeybees, 2011. In these papers the cue is light from above
engine::ControllerKind beeclust_controller();

}  // namespace troupe::models
