#pragma once

#include "engine/kinds/measure_kind.hpp"

namespace troupe::models {

/// Returns the definition of the measure `rank_errors`, a number computed from the positions of the robots.
/// It tells how far robots of different types are from being sorted by their distance to the point `center`
/// (a parameter), in the order in which the world file lists the types. The measure considers all pairs of
/// robots of different types. A pair is in the wrong order if the robot whose type comes later in the world
/// file is nearer to `center` than the other robot. The value is the fraction of the pairs that are in the
/// wrong order (docs/measures.md). NaN if all robots in the world are of one type.
engine::MeasureKind rank_errors_measure();

}  // namespace troupe::models
