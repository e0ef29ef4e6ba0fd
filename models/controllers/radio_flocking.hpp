#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Flocking by radio: each robot broadcasts its heading, turns to the mean of the headings that it hears, and
/// keeps its distance from these robots.
///
/// aims      along a = h + `spacing_weight` p, robot frame: h is the normalised mean of its own heading and
///           the headings heard; p is the mean, over the robots heard, of 1 - (`distance` / range)^2,
///           clamped to -5 and 0.3, along their bearings. With a ranger, obstacles nearer than `clearance`
///           add a repulsion
/// drives    `speed` times the cosine of the angle to a, backwards at most at half of `speed`; turns at
///           `gain` times the angle
/// needs     a drive, a radio with a payload of 4 bytes or more; its heading is that of the estimated pose
/// source    Turgut, Celikkanat, Gokce, Sahin: Self-organized flocking in mobile robot swarms, Swarm
///           Intelligence 2, 2008: their heading alignment and proximal control, with a radio as the "virtual
///           heading sensor"
engine::ControllerKind radio_flocking_controller();

}  // namespace troupe::models
