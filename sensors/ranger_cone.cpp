#include "sensors/ranger_cone.hpp"

#include "engine/sensing/visibility_query.hpp"

#include <algorithm>
#include <memory>

namespace troupe::sensors {
namespace {

constexpr double k_slack = 1e-6;  // m: above all rounding errors of distances

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

void cast_cones(const engine::SensingView& view, Row own, const engine::Mount& mount,
                const Transducer& transducer, std::span<const double> headings, std::span<float> ranges,
                std::span<float> intensities) {
  thread_local const auto near = std::make_unique<engine::VisibilityQuery>();
  const Vec2 tip = mount.transform * transducer.pose.position();
  const double z = mount.z + transducer.pose.z;
  const double half_width = transducer.params.beam_width / 2;
  near->stand(view, tip, ranges.empty() ? 0 : std::ranges::max(ranges), own, z);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double heading = mount.heading + headings[i];
    const Vec2 right = Rotation(heading - half_width) * Vec2::UnitX();
    const Vec2 left = Rotation(heading + half_width) * Vec2::UnitX();
    double nearest = ranges[i];
    const auto may_be_nearer = [&](double x, double y, double radius) {
      const Vec2 centre(x, y);
      const double reach = radius + k_slack;
      return cross(right, centre) >= -reach && cross(centre, left) >= -reach &&
             centre.norm() <= nearest + reach;
    };
    near->for_each_chain(may_be_nearer, [&](const engine::OutlineChain& chain) {
      if (chain.ranger_return < 0 || !chain.z.contains(z)) return;
      engine::for_each_edge(chain, [&](const Vec2& a, const Vec2& b) {
        const auto range = nearest_in_cone(right, left, a - tip, b - tip);
        if (!range || *range > nearest || *range >= transducer.params.range_max) return;
        if (!intensities.empty())  // at equal distances the larger one, as for beams without a width
          intensities[i] =
              *range < nearest ? chain.ranger_return : std::max(intensities[i], chain.ranger_return);
        nearest = *range;
      });
    });
    ranges[i] = static_cast<float>(nearest);
  }
}

}  // namespace troupe::sensors
