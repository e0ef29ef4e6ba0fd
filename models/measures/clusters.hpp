#pragma once

#include "engine/measure_kind.hpp"

/// Measures of how things lie together. Their definitions stand in the kinds (`troupe describe`).
namespace troupe::models {

engine::MeasureKind clusters_measure();  ///< `clusters`: in how many heaps the pushable bodies lie
/// `largest_cluster`: which share of them lies in the largest.
engine::MeasureKind largest_cluster_measure();

}  // namespace troupe::models
