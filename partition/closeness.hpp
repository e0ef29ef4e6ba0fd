#pragma once

#include "partition/placed_shape.hpp"

namespace troupe::partition {

/// True when some piece of one shape overlaps, touches or comes within `distance` (m) of some piece of the
/// other, seen from above: heights do not count. In double; a distance of exactly `distance` counts.
bool come_within(const PlacedShape& a, const PlacedShape& b, double distance);

}  // namespace troupe::partition
