#pragma once

#include "engine/kinds/measure_kind.hpp"

/// Definitions of measures (numbers computed from the state of the simulation) of the distances between
/// robots. The program `troupe describe` prints the definitions as text.
namespace troupe::models {

/// `mean_nearest_distance`, m: mean over the robots of the distance to the nearest other robot; NaN for fewer
/// than two robots.
engine::MeasureKind mean_nearest_distance_measure();
/// `neighbours`: mean over the robots of the number of other robots within the distance `radius` (m, a
/// parameter); NaN without robots.
engine::MeasureKind neighbours_measure();

}  // namespace troupe::models
