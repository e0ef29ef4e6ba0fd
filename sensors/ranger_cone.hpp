#pragma once

#include "engine/world.hpp"
#include "sensors/ranger_beams.hpp"

#include <optional>
#include <span>

namespace troupe::sensors {

/// Distance from the origin to the nearest point of an edge that lies within a cone of up to 180 degrees:
/// left of `right` and right of `left`, two unit vectors. Empty where none does.
std::optional<double> nearest_in_cone(const Vec2& right, const Vec2& left, const Vec2& a, const Vec2& b);

/// Beams that are as wide as a sonar's: each reading becomes the distance to the nearest surface point
/// anywhere within its beam, which is never farther than what its middle met. Exact: no rays are sampled.
/// mount: the frame in which the ranger's beams are given.
void look_in_cones(const engine::World& world, Row own, const engine::Mount& mount,
                   const TransducerExtras& extras, std::span<float> ranges, std::span<float> intensities);

}  // namespace troupe::sensors
