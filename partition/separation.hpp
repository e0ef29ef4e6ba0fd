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

/// Whether a motion takes a shape deeper into another one. `before` and `after` are the shape at the
/// beginning and at the end of the motion, with the same pieces in the same order; `other` is the shape that
/// stays.
///
/// The depth of two pieces is the length of the shortest horizontal displacement that separates them, and 0
/// if they share no area or are at no common height. The result is true if the depth of any piece in any
/// piece of `other` is greater after the motion. If both depths are above 0, a difference that may be a
/// rounding error does not count: one of at most 1e-12 m, or with a depth of at most k_rounding_m afterwards.
bool deepens(const PlacedShape& before, const PlacedShape& after, const PlacedShape& other);

}  // namespace troupe::partition
