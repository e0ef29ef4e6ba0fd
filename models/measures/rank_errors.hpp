#pragma once

#include "engine/kinds/measure_kind.hpp"

namespace troupe::models {

/// Returns the definition of the measure `rank_errors`, a number computed from the poses of the robots: the
/// fraction of the pairs of robots of different types (constructions, in the world file) that are in the
/// wrong order. Let A be the robot of a pair whose type comes later in the world file. The pair is in the
/// wrong order if A is nearer to the point `center` (a parameter) than the other robot (docs/measures.md).
/// NaN if all robots in the world are of one type.
engine::MeasureKind rank_errors_measure();

}  // namespace troupe::models
