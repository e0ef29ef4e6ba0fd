#pragma once

#include "partition/placed_shape.hpp"

namespace troupe::partition {

/// A PlacedShape is the shape of a body, made of convex pieces, at a pose. Returns true if, seen from above,
/// a piece of one shape overlaps or touches a piece of the other shape, or is at most `distance` (metres)
/// away from it. Heights are ignored. False if a shape has no pieces. `distance` must not be negative.
bool come_within(const PlacedShape& a, const PlacedShape& b, double distance);

}  // namespace troupe::partition
