#pragma once

#include "partition/placed_shape.hpp"

namespace troupe::partition {

/// Returns whether the distance between two shapes, seen from above, is at most `distance` (metres, not
/// negative). Shapes that overlap or touch have the distance 0. Heights are ignored. False if a shape is
/// empty. A PlacedShape is the shape of a body at a pose.
bool come_within(const PlacedShape& a, const PlacedShape& b, double distance);

}  // namespace troupe::partition
