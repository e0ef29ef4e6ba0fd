#pragma once

#include "partition/placed_shape.hpp"

namespace troupe::partition {

/// True if some piece of one shape overlaps, touches or comes within `distance` (metres, inclusive) of some
/// piece of the other, seen from above: heights are ignored. False if a shape has no pieces. `distance` must
/// not be negative.
bool come_within(const PlacedShape& a, const PlacedShape& b, double distance);

}  // namespace troupe::partition
