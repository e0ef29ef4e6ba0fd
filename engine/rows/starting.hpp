#pragma once

#include "base/ids.hpp"
#include "base/pose.hpp"
#include "engine/state/world_state.hpp"

namespace troupe::engine {

/// Returns `pose` with its heading wrapped and -0 replaced by 0, so that equal poses have equal bits.
Pose canonical(const Pose& pose);

/// Gives a row the state that its body has at tick 0 or at its birth, with this pose (world frame). All bytes
/// of the row must be 0 before. Computes no derived data. Throws StepError if a hook `start` of a kind
/// throws, or if the velocity with which a drive starts is not finite.
void start(WorldState& state, Row row, const Pose& pose);

}  // namespace troupe::engine
