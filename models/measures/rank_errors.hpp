#pragma once

#include "engine/kinds/measure_kind.hpp"

namespace troupe::models {

/// Returns the definition of the measure `rank_errors` (docs/measures.md), a number that is computed from the
/// positions of the robots. It tells how well the types of robots are sorted by distance to the point
/// `center` (m, world frame; a parameter). In the right order, robots of the type that the world file lists
/// first are nearest to `center`, robots of the second type are next, and so on.
///
/// The value is the fraction of wrong pairs among all pairs of robots of different types. A pair is wrong if
/// the robot whose type is listed later is nearer to `center` than the other robot. The value is 0 if all
/// pairs are in the right order. NaN if there is no pair of robots of different types.
engine::MeasureKind rank_errors_measure();

}  // namespace troupe::models
