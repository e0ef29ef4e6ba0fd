#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Flocking by radio: each robot says its heading, turns to the mean heading of those that it hears, and
/// keeps its distance from them.
///
/// aims      along a = h + `spacing_weight` p, robot frame: h is the mean, made a unit vector, of its own
///           heading and of those heard; p the mean over those heard of (range - distance) / distance, kept
///           within +-1, along their bearings; with a scanner, walls nearer than `clearance` push away
/// drives    `speed` times the cosine of the angle to a, never backwards, and turns by `gain` times the angle
/// needs     a drive, a radio with a payload of 4 bytes or more; its heading is that of its estimate
/// source    Turgut, Celikkanat, Gokce, Sahin: Self-organized flocking in mobile robot swarms, Swarm
///           Intelligence 2, 2008: their heading alignment and proximal control, with a radio as the "virtual
///           heading sensor"
engine::ControllerKind radio_flocking_controller();

}  // namespace troupe::models
