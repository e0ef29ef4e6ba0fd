#pragma once

#include "partition/placed_shape.hpp"

#include <optional>

namespace troupe::partition {

/// A PlacedShape is the shape of a body, made of pieces (convex prisms), at a pose. Returns the shortest
/// horizontal displacement of `b`, metres, world frame, after which `b` only touches `a`. Empty if the shapes
/// do not overlap at a common height. If a shape has several pieces, the result is the displacement for the
/// pair of pieces with the deepest penetration. After this displacement the shapes may still overlap: the
/// caller must move `b` and call the function again. Uses separating axes: the shortest displacement of two
/// convex polygons is along the normal of one of their edges. Ties: the first pair of pieces wins; within a
/// pair, the edges of `a` come before those of `b`, each in their order.
std::optional<Vec2> way_out(const PlacedShape& a, const PlacedShape& b);

}  // namespace troupe::partition
