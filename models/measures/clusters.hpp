#pragma once

#include "engine/kinds/measure_kind.hpp"

/// Definitions of measures of clusters of bodies. A measure is a number that is computed from the state of
/// the simulation. The parameter `bodies` of a measure selects the bodies: all pushable bodies (objects that
/// robots can push), or robots.
///
/// Two bodies are neighbours if their origins are at most `distance` (m, a parameter) apart. Bodies are in
/// the same cluster if a chain of neighbours connects them. A body without neighbours is a cluster of one.
namespace troupe::models {

engine::MeasureKind clusters_measure();  ///< `clusters`: number of clusters
/// `largest_cluster`: number of bodies in the largest cluster, divided by the number of bodies in all
/// clusters. NaN if there are no bodies of the selected sort in the world.
engine::MeasureKind largest_cluster_measure();

}  // namespace troupe::models
