#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Aggregation by a cue, with no sense of where the cue is: who meets another waits there, the longer the
/// brighter the ground is.
///
/// walks     straight on, and turns by a random angle away from what its scanner sees nearer than `min_front`
/// meets     another whose radio it hears from no farther than `meet` and within 60 degrees ahead; a wall
///           says nothing, and is turned away from
/// waits     `max_wait` S^2 / (S^2 + `half`), s, with S the brightness of the ground below it from 0 to 1,
///           read when it stops; then it turns by 90 to 180 degrees, and walks on
/// shows     with an LED, where it has one: blue while it walks, amber while it waits
/// needs     a drive, a ground sensor, a radio, a scanner of more than 8 beams
/// source    Schmickl, Thenius, Moeslinger, Radspieler, Kernbach, Szymanski, Crailsheim: Get in touch:
///           cooperative decision making based on robot-to-robot collisions, Autonomous Agents and
///           Multi-Agent Systems 18, 2009; the name and the law of waiting: Schmickl, Hamann: BEECLUST: a
///           swarm algorithm derived from honeybees, 2011. There the cue is the light from above
engine::ControllerKind beeclust_controller();

}  // namespace troupe::models
