#pragma once

#include "base/diagnostics.hpp"
#include "engine/state/world_state.hpp"
#include "partition/parallel.hpp"

namespace troupe::engine {

/// Warns about bodies that overlap at tick 0, and about bodies that extend below the floor (z = 0). If
/// diagnostics.thorough() is true, each of the first hundred pairs that overlap gets a warning of its own,
/// and one more has the number of further pairs. Otherwise one warning says how many pairs overlap, counted
/// up to 10,000.
void report_overlaps(const WorldState& state, partition::Parallel& parallel, Diagnostics& diagnostics);

}  // namespace troupe::engine
