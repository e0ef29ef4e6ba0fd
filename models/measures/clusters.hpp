#pragma once

#include "engine/kinds/measure_kind.hpp"

/// Definitions of measures (numbers computed from the state of the simulation) of the clusters that robots or
/// pushable bodies (objects that robots can push) form. The parameter `bodies` of a measure selects which of
/// the two. Two bodies are in one cluster if their origins are at most `distance` (m, a parameter) apart.
/// They are also in one cluster if a chain of bodies connects them, and each body of the chain is at most
/// `distance` from the next. A body without neighbours is a cluster of one. The program `troupe describe`
/// prints the definitions as text.
namespace troupe::models {

engine::MeasureKind clusters_measure();  ///< `clusters`: number of clusters
/// `largest_cluster`: fraction of the pushable bodies or of the robots that are in the largest cluster; NaN
/// if there are none.
engine::MeasureKind largest_cluster_measure();

}  // namespace troupe::models
