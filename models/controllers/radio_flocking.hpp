#pragma once

#include "engine/kinds/controller_kind.hpp"

namespace troupe::models {

/// Returns the definition of the controller `radio_flocking`: robots flock by means of their radios. Each
/// robot broadcasts its heading, turns to the mean of the headings that it hears, and keeps a distance to the
/// robots that it hears.
///
/// Names in backquotes are parameters.
///
/// aims      The robot aims along the vector a = h + `spacing_weight` p + o, in its own frame.
///           h  unit vector in the direction of the mean of all headings that the robot hears and its own
///           p  mean of the vectors w u of all robots that it hears, which keeps the distance to them near
///              `distance` (m). u is the unit vector towards the other robot. w = 1 - (`distance` / r)^2,
///              clamped to the interval from -5 to 0.3, where r is the distance between the radios. So near
///              robots repel (w < 0) and far robots attract (w > 0)
///           o  repulsion by obstacles that the ranger of the robot sees nearer than `clearance` (m); 0
///              without a ranger
/// drives    The forward speed is `speed` times cos(b), where b is the angle from straight ahead to a, but
///           not below -`speed` / 2. The turn rate is `gain` times b.
/// headings  The heading that a robot broadcasts is that of its estimated pose. So the frames of the
///           estimated poses of all robots should have the same orientation.
/// needs     a drive, a radio with a payload of 4 bytes or more
/// source    Turgut, Celikkanat, Gokce, Sahin: Self-organized flocking in mobile robot swarms, Swarm
///           Intelligence 2, 2008: the sum of a vector for heading alignment and a vector for proximal
///           control, with a radio as the "virtual heading sensor". The formulas of p and o and all constants
///           are our own: the robots of the paper measure the distance to each other with infrared sensors,
///           here by radio
engine::ControllerKind radio_flocking_controller();

}  // namespace troupe::models
