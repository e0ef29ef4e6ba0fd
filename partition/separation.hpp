#pragma once

#include "partition/placed_shape.hpp"

#include <optional>

namespace troupe::partition {

/// The shortest displacement of `b`, metres, world frame, after which it only touches `a`. For shapes of
/// several pieces it is that of the pair with the deepest penetration; the shapes may then still overlap, so
/// call again. Empty if the shapes do not overlap. Separating axes: the shortest displacement of two convex
/// polygons is along the normal of one of their edges. Ties: the first pair of pieces; within a pair the
/// edges of a before those of b, each in their order.
std::optional<Vec2> way_out(const PlacedShape& a, const PlacedShape& b);

}  // namespace troupe::partition
