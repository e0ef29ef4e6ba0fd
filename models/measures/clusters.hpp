#pragma once

#include "engine/measure_kind.hpp"

/// Measures of the clusters that pushable bodies form. `troupe describe` prints their definitions.
namespace troupe::models {

engine::MeasureKind clusters_measure();  ///< `clusters`: number of clusters of pushable bodies
/// `largest_cluster`: fraction of the pushable bodies that are in the largest cluster.
engine::MeasureKind largest_cluster_measure();

}  // namespace troupe::models
