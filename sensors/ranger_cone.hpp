#pragma once

#include "engine/sensing/sensing_view.hpp"
#include "sensors/ranger_beams.hpp"

#include <optional>
#include <span>

namespace troupe::sensors {

/// Returns the distance, metres, from the tip of a cone to the nearest point of the edge from a to b within
/// the cone. The tip is the origin of all coordinates. The cone opens by at most 180 degrees,
/// counter-clockwise from the unit vector `right` to the unit vector `left`. Points on the sides of the cone
/// are within the cone. The result is std::nullopt if no point of the edge is within the cone.
std::optional<double> nearest_in_cone(const Vec2& right, const Vec2& left, const Vec2& a, const Vec2& b);

/// Gives the beams of a transducer (fan of beams of a ranger, which is a range sensor) a width, as those of a
/// sonar have. Each reading was measured along the middle of its beam. It becomes the distance to the nearest
/// surface point within the width of the beam, if that distance is less. Only surfaces that the middle of the
/// beam could hit count: surfaces with ranger_return >= 0 at the height of the transducer, but no surface of
/// the body that carries the ranger or of bodies that move with this body. The result is exact, not sampled
/// with rays.
///
/// view         read access to the state of the world
/// own          the row (index in the state tables) of the body that carries the ranger
/// mount        the frame in which the ranger's beams are given, relative to the world
/// extras       the transducer; its beam_width must be above 0
/// headings     the headings of the beams in this tick (time step), with angular noise, rad, in the frame
///              `mount`
/// ranges       the readings of the transducer along the middle of its beams, m, which are updated
/// intensities  the intensities of the transducer, updated with the ranges; empty if it has none
void cast_cones(const engine::SensingView& view, Row own, const engine::Mount& mount,
                const TransducerExtras& extras, std::span<const double> headings, std::span<float> ranges,
                std::span<float> intensities);

}  // namespace troupe::sensors
