#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Dispersal by ranges: turn towards the vector sum of the beams, drive while the way ahead is clear.
/// Reads all beams of the first ranger that no other controller of the robot has claimed.
/// edges   A vector sum below 1e-6 of the sum of the ranges has no direction (a ring of beams in the open):
///         the robot drives straight ahead. If the sum points straight ahead (within 1e-6 rad) but the way
///         is not clear, it turns left. With `hold_on_axis` it does neither: as in Stage, a sum exactly on
///         an axis leaves the last command
/// source  Vaughan, Massively multi-robot simulation in Stage, section 6.1; `invert` reverses the sum, so
///         that robots gather: the paper's clustering variant
engine::ControllerKind expand_controller();

/// `expand` with the exact numbers of Stage's two examples.
///@{
engine::Registry::Preset expand_pioneer_preset();
engine::Registry::Preset expand_swarm_preset();
///@}

}  // namespace troupe::models
