#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Dispersal by ranges: a robot turns towards the vector sum of its beams and drives while the way ahead is
/// clear. Each beam contributes a vector along the beam whose length is its reading. The controller reads all
/// beams of the first ranger that no other controller of the robot has claimed.
/// edges   If the vector sum is shorter than 1e-6 times the sum of the ranges, as in a ring of beams in open
///         space, it has no direction, and the robot drives straight ahead. If the sum points straight ahead
///         (within 1e-6 rad) but the way is not clear, the robot turns left. With `hold_on_axis` neither rule
///         applies: as in Stage, the robot repeats its last command if the sum lies exactly on the x or y
///         axis
/// source  Vaughan, Massively multi-robot simulation in Stage, section 6.1. `invert` reverses the sum, so
///         that robots gather: the clustering variant in the paper
engine::ControllerKind expand_controller();

/// `expand` with exactly the parameters of two examples of Stage.
///@{
engine::Registry::Preset expand_pioneer_preset();
engine::Registry::Preset expand_swarm_preset();
///@}

}  // namespace troupe::models
