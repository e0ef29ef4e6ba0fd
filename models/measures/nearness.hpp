#pragma once

#include "engine/measure_kind.hpp"

/// Measures of how near robots are to one another. Their definitions stand in the kinds (`troupe describe`).
namespace troupe::models {

engine::MeasureKind mean_nearest_distance_measure();  ///< `mean_nearest_distance`, m
engine::MeasureKind neighbours_measure();             ///< `neighbours`: mean number within a radius

}  // namespace troupe::models
