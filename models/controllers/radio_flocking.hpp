#pragma once

#include "engine/kinds/kinds.hpp"

namespace troupe::models {

/// Returns the definition of the controller `radio_flocking`: flocking by radio. Each robot broadcasts its
/// heading, turns to the mean of the headings that it hears, and keeps the distance `distance` (m) from the
/// robots that it hears.
///
/// aims      The robot aims along the vector a = h + `spacing_weight` p in its own frame. Names in backquotes
///           are parameters. h is the unit vector in the direction of the mean of its own heading and the
///           headings that it hears. p is the mean of the vectors w u of the robots that it hears. For each
///           of these robots, u is the unit vector towards it, r is the distance between the radios, and w =
///           1 - (`distance` / r)^2, clamped to the interval from -5 to 0.3. Near robots repel (w < 0) and
///           far robots attract (w > 0). If the robot has a ranger, obstacles nearer than `clearance` (m) add
///           a repulsion to a.
/// drives    The forward speed is `speed` times cos(b), where b is the angle of a from straight ahead, but
///           not below -`speed` / 2. The turn rate is `gain` times b.
/// needs     a drive, a radio with a payload of 4 bytes or more. The heading that a robot broadcasts is that
///           of its estimated pose
/// source    Turgut, Celikkanat, Gokce, Sahin: Self-organized flocking in mobile robot swarms, Swarm
///           Intelligence 2, 2008: their heading alignment and proximal control, with a radio as the "virtual
///           heading sensor"
engine::ControllerKind radio_flocking_controller();

}  // namespace troupe::models
