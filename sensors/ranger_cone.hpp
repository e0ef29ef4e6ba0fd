#pragma once

#include "engine/world.hpp"
#include "sensors/ranger_beams.hpp"

#include <optional>
#include <span>

namespace troupe::sensors {

/// The distance from the origin to the nearest point of edge (a, b) within a cone of up to 180 degrees: left
/// of `right` and right of `left`, two unit vectors. Empty if no point of the edge is within the cone.
std::optional<double> nearest_in_cone(const Vec2& right, const Vec2& left, const Vec2& a, const Vec2& b);

/// Gives the beams a width, as of a sonar: each reading becomes the distance to the nearest surface point
/// within its beam, which is never more than the reading along its middle. Exact: does not sample rays.
/// mount: the frame in which the ranger's beams are given
void cast_cones(const engine::World& world, Row own, const engine::Mount& mount,
                const TransducerExtras& extras, std::span<float> ranges, std::span<float> intensities);

}  // namespace troupe::sensors
