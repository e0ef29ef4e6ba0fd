#pragma once

#include "engine/measure_kind.hpp"

/// Measures of how things lie together. Their definitions stand in the kinds (`troupe describe`).
namespace troupe::models {

engine::MeasureKind clusters_measure();
engine::MeasureKind largest_cluster_measure();

}  // namespace troupe::models
