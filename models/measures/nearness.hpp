#pragma once

#include "engine/kinds/measure_kind.hpp"

/// Definitions of measures of the distances between robots. A measure is a number that is computed from the
/// state of the simulation. All distances are between the origins of robots. The command `troupe describe
/// NAME` prints the definition of a measure.
namespace troupe::models {

/// `mean_nearest_distance`, m: mean over the robots of the distance to the nearest other robot; NaN for fewer
/// than two robots.
engine::MeasureKind mean_nearest_distance_measure();
/// `neighbours`: mean over the robots of the number of other robots within the distance `radius` (m, a
/// parameter) of a robot; NaN without robots.
engine::MeasureKind neighbours_measure();

}  // namespace troupe::models
