#pragma once

#include "engine/measure_kind.hpp"

/// Measures of the distances between robots. `troupe describe` prints their definitions.
namespace troupe::models {

/// `mean_nearest_distance`, m: mean distance to the nearest other robot.
engine::MeasureKind mean_nearest_distance_measure();
engine::MeasureKind neighbours_measure();  ///< `neighbours`: mean number of robots within a radius

}  // namespace troupe::models
