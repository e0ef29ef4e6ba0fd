#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Aggregation by a cue, without sensing the direction of the cue: a robot that meets another one waits
/// there, the longer the brighter the ground is.
///
/// walks     straight on, and turns by a random angle away from obstacles nearer than `min_front`
/// meets     a robot whose radio it hears within `meet` and within 60 degrees of straight ahead. A wall sends
///           nothing: the robot turns away from it
/// waits     `max_wait` S^2 / (S^2 + `half`), s, where S is the brightness of the ground below it, 0 to 1,
///           read when it stops; then turns by 90 to 180 degrees and walks on
/// shows     by an LED, if it has one: blue while it walks, amber while it waits
/// needs     a drive, a ground sensor, a radio, a scanner of more than 8 beams
/// source    Schmickl, Thenius, Moeslinger, Radspieler, Kernbach, Szymanski, Crailsheim: Get in touch:
///           cooperative decision making based on robot-to-robot collisions, Autonomous Agents and
///           Multi-Agent Systems 18, 2009; the name and the law of waiting: Schmickl, Hamann: BEECLUST: a
///           swarm algorithm derived from honeybees, 2011. In the paper the cue is light from above
engine::ControllerKind beeclust_controller();

}  // namespace troupe::models
