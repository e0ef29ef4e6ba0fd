#pragma once

#include "partition/placed_shape.hpp"

#include <optional>

namespace troupe::partition {

/// Returns the shortest horizontal displacement of `b`, metres, world frame, after which `b` only touches
/// `a`. Empty if the shapes do not overlap at a common height. A PlacedShape is the shape of a body at a
/// pose; it is made of convex prisms, called pieces.
///
/// If a shape has several pieces, the result separates only the two pieces that penetrate each other most
/// deeply. The shapes may still overlap afterwards. The caller must then move `b` and call the function
/// again.
///
/// The displacement is along the normal of an edge of one of the two pieces. Of several equally short
/// displacements, the function returns the first that it finds. It searches the edges of a piece of `a`
/// before those of a piece of `b`.
std::optional<Vec2> way_out(const PlacedShape& a, const PlacedShape& b);

}  // namespace troupe::partition
