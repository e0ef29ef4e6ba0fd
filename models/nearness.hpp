#pragma once

#include "engine/measure_kind.hpp"

/// Measures of how near robots are to one another. Their definitions stand in the kinds (`troupe describe`).
namespace troupe::models {

engine::MeasureKind mean_nearest_distance_measure();
engine::MeasureKind neighbours_measure();

}  // namespace troupe::models
