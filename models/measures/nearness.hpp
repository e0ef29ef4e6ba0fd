#pragma once

#include "engine/measure_kind.hpp"

/// Measures of the distances between robots. `troupe describe` prints their definitions.
namespace troupe::models {

engine::MeasureKind mean_nearest_distance_measure();  ///< `mean_nearest_distance`, m
engine::MeasureKind neighbours_measure();             ///< `neighbours`: mean number within a radius

}  // namespace troupe::models
