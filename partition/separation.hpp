#pragma once

#include "partition/placed_shape.hpp"

#include <optional>

namespace troupe::partition {

/// The shortest way, m, on which `b` must be shifted so that it only touches `a`. Of shapes of several pieces
/// that of the two pieces that reach farthest into one another, so that the shapes may still overlap then:
/// ask again. Nothing where the shapes do not overlap. ties    the first pair of pieces; of a pair the edges
/// of a before those of b, each in their order source  separating axes: the way out of two convex polygons
/// runs along the normal of one of their edges
std::optional<Vec2> way_out(const PlacedShape& a, const PlacedShape& b);

}  // namespace troupe::partition
