#pragma once

#include "engine/world.hpp"
#include "sensors/ranger_beams.hpp"

#include <optional>
#include <span>

namespace troupe::sensors {

/// Returns the distance from the origin to the nearest point of edge (a, b) within a cone of up to 180
/// degrees. The cone lies to the left of the direction `right` and to the right of the direction `left`, two
/// unit vectors. Empty if no point of the edge is within the cone.
std::optional<double> nearest_in_cone(const Vec2& right, const Vec2& left, const Vec2& a, const Vec2& b);

/// Gives beams a width, as a sonar has: each reading becomes the distance to the nearest surface point within
/// the width of its beam, which is at most the reading along the middle of the beam. The result is exact, not
/// sampled with rays.
/// own: the row that carries the ranger. mount: the frame in which the ranger's beams are given. ranges,
/// intensities: the readings of the transducer that `extras` describes; intensities may be empty
void cast_cones(const engine::World& world, Row own, const engine::Mount& mount,
                const TransducerExtras& extras, std::span<float> ranges, std::span<float> intensities);

}  // namespace troupe::sensors
