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

/// Gives the beams of a transducer a width, like the width of a sonar beam. A transducer is a fan of beams of
/// a ranger (range sensor). Call this function after the beams have been cast as thin rays. It lowers each
/// range to the distance of the nearest surface point within the width of the beam. The function uses the
/// same surfaces as the thin rays: those with ranger_return >= 0 whose z interval contains the height of the
/// beams. It ignores the body that carries the ranger and all bodies that move together with this body. The
/// distances are exact, not sampled with rays.
///
/// view         read access to the state of the world
/// own          row (index in the state tables) of the body that carries the ranger
/// mount        the frame in which transducer.pose and `headings` are given, relative to the world frame
/// transducer   its beam_width must be above 0
/// headings     the headings of the middle lines of the beams in this tick (time step), rad; they include
///              angular noise
/// ranges       before the call: the distances along the middle lines of the beams, m; after it: the
///              distances within the widths of the beams
/// intensities  the intensities of the surfaces at these distances, updated together with `ranges`; empty if
///              the ranger reports no intensities
void cast_cones(const engine::SensingView& view, Row own, const engine::Mount& mount,
                const Transducer& transducer, std::span<const double> headings, std::span<float> ranges,
                std::span<float> intensities);

}  // namespace troupe::sensors
