#pragma once

#include "engine/kinds.hpp"

namespace troupe::models {

/// Dispersal by ranges: turn towards the vector sum of the beams, drive while the way ahead is clear.
/// Reads the first ranger that no controller of the robot has taken yet, with all beams of all transducers.
/// edges   a sum of no direction (below 1e-6 of the sum of the ranges), as of a ring of beams in the open:
///         straight ahead. Straight ahead (within 1e-6 rad) and not clear: it turns left. With
///         `hold_on_axis` neither, as in Stage: a sum exactly on an axis leaves the last command
/// source  Vaughan, Massively multi-robot simulation in Stage, section 6.1; `invert` turns the sum around, so
///         that robots gather: the paper's clustering variant
engine::ControllerKind expand_controller();

/// Stage's two examples, with exactly their numbers.
///@{
engine::Registry::Preset expand_pioneer_preset();
engine::Registry::Preset expand_swarm_preset();
///@}

}  // namespace troupe::models
