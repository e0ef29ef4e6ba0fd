#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Flocking by radio: each robot says its heading, turns to the mean heading of those that it hears, and
/// keeps its distance from them.
///
/// aims      along a = h + `spacing_weight` p, robot frame: h is the mean, made a unit vector, of its own
///           heading and of those heard; p the mean over those heard of 1 - (distance / range)^2, kept
///           within -5 and 0.3, along their bearings; with a scanner, what is nearer than `clearance` pushes
///           away
/// drives    `speed` times the cosine of the angle to a, backwards at half of it at most, and turns by `gain`
///           times the angle
/// needs     a drive, a radio with a payload of 4 bytes or more; its heading is that of its estimate
/// source    Turgut, Celikkanat, Gokce, Sahin: Self-organized flocking in mobile robot swarms, Swarm
///           Intelligence 2, 2008: their heading alignment and proximal control, with a radio as the "virtual
///           heading sensor"
engine::ControllerKind radio_flocking_controller();

}  // namespace troupe::models
