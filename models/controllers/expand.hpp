#pragma once

#include "engine/kinds/kinds.hpp"

namespace troupe::models {

/// Returns the definition of the controller `expand`: robots disperse by means of their range readings. A
/// robot turns towards the vector sum of its beams. Each beam contributes a vector along the beam whose
/// length is the reading of the beam. The robot drives while every reading exceeds the clearance of its beam
/// and the sum is within the angle `cone` (rad, a parameter) of straight ahead. The clearance of a beam at
/// the angle a from straight ahead is the parameter `clearance` (m) times cos(a). The parameter `clearances`
/// replaces this formula by one clearance (m) per transducer (fan of beams). The controller reads all beams
/// of the first ranger that no other controller of the robot has claimed.
/// edges   If the length of the vector sum is at most 1e-6 times the sum of the readings, the sum has no
///         direction, and straight ahead is used instead. This happens with a ring of beams in open space. If
///         the sum points straight ahead (within 1e-6 rad) but the way is not clear, the robot turns left,
///         unless `invert` is set. With `hold_on_axis`, neither rule applies. Instead, as in Stage, the robot
///         repeats its last command if the sum lies exactly on the x or y axis
/// source  Vaughan, Massively multi-robot simulation in Stage, section 6.1. The parameter `invert` reverses
///         the sum, so that robots gather: this is the clustering variant in the paper
engine::ControllerKind expand_controller();

/// Return two presets of `expand`. A preset is a controller with a name and default parameters of its own.
/// These two have exactly the parameters of two examples of Stage: `expand_pioneer` for Stage's cave
/// benchmark (16 sonars), `expand_swarm` for Stage's hospital benchmark (a ring of 12 infrared rangers).
///@{
engine::Registry::Preset expand_pioneer_preset();
engine::Registry::Preset expand_swarm_preset();
///@}

}  // namespace troupe::models
