#include "sensors/ranger_cone.hpp"

#include "engine/sight.hpp"

#include <algorithm>

namespace troupe::sensors {
namespace {

constexpr double k_slack = 1e-6;  // m: margin of the box about a cone, above all rounding errors

/// A box that contains all points of a cone up to `length` (m) from its tip. It spans the tip, the ends of
/// the two sides, and two corners of a polygon that is tangent to the arc from outside. heading: of the
/// middle of the cone, rad. half_width: half the opening angle, rad.
Box box_about(const Vec2& tip, double heading, double half_width, double length) {
  Box box;
  box.extend(tip);
  const double corner = length / cos(half_width / 2);
  for (const double side : {-half_width, half_width}) {
    box.extend(Vec2(tip + length * (Rotation(heading + side) * Vec2::UnitX())));
    box.extend(Vec2(tip + corner * (Rotation(heading + side / 2) * Vec2::UnitX())));
  }
  return box.expanded(k_slack);
}

}  // namespace

std::optional<double> nearest_in_cone(const Vec2& right, const Vec2& left, const Vec2& a, const Vec2& b) {
  // The part of the edge a + t (b - a) that is within both sides of the cone: t from `from` to `to`.
  double from = 0;
  double to = 1;
  const auto clip = [&](double at_a, double at_b) {  // distances of the ends from a side, positive within
    if (at_a < 0 && at_b < 0) return false;
    if (at_a < 0) from = std::max(from, at_a / (at_a - at_b));
    if (at_b < 0) to = std::min(to, at_a / (at_a - at_b));
    return from <= to;
  };
  if (!clip(cross(right, a), cross(right, b)) || !clip(cross(a, left), cross(b, left))) return {};
  const Vec2 along = b - a;
  const double length2 = along.squaredNorm();
  const double foot = length2 > 0 ? -a.dot(along) / length2 : 0.0;
  return (a + std::clamp(foot, from, to) * along).norm();
}

void cast_cones(const engine::World& world, Row own, const engine::Mount& mount,
                const TransducerExtras& extras, std::span<float> ranges, std::span<float> intensities) {
  const Vec2 tip = mount.transform * extras.origin;
  const double z = mount.z + extras.z;
  const double half_width = extras.beam_width / 2;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double heading = mount.heading + extras.headings[i];
    const Vec2 right = Rotation(heading - half_width) * Vec2::UnitX();
    const Vec2 left = Rotation(heading + half_width) * Vec2::UnitX();
    double nearest = ranges[i];
    const auto may_be_nearer = [&](const partition::BodyCircle& circle) {
      return (Vec2(circle.x, circle.y) - tip).norm() - circle.radius <= nearest + k_slack;
    };
    const auto visit = [&](const engine::OutlineChain& chain) {
      if (chain.ranger_return < 0 || !chain.z.contains(z)) return;
      engine::for_each_edge(chain, [&](const Vec2& a, const Vec2& b) {
        const auto range = nearest_in_cone(right, left, a - tip, b - tip);
        if (!range || *range > nearest || *range >= extras.range_max) return;
        if (!intensities.empty())  // at equal distances the larger one, as for beams without a width
          intensities[i] =
              *range < nearest ? chain.ranger_return : std::max(intensities[i], chain.ranger_return);
        nearest = *range;
      });
    };
    const Box box = box_about(tip, heading, half_width, nearest);
    engine::for_each_fixed_chain(world, box, may_be_nearer, visit);
    engine::for_each_body_chain(world, box, own, may_be_nearer, visit);
    ranges[i] = static_cast<float>(nearest);
  }
}

}  // namespace troupe::sensors
