#include "engine/ranks/halo.hpp"

#include <algorithm>

namespace troupe::engine {

Halo::Extent Halo::extent_of(const World& world) {
  Extent extent{.reach = world.interventions().settings().longest_reach(),
                .radius = world.links().farthest_in_trees()};
  std::size_t limit = 0;
  for (const BodyType& type : world.view().types()) {
    if (!type.runs()) continue;
    const double shift = Links::farthest_shift(type);
    extent.shift = std::max(extent.shift, shift);
    extent.radius = std::max(extent.radius, std::max(type.radius, type.obstacle.radius) + shift);
    extent.has_trees = extent.has_trees || type.carries;
    if (type.drive) limit = std::max<std::size_t>(limit, type.drive->pushes);
    if (!type.pushable) continue;
    extent.has_pushable = true;
    extent.pushable_radius = std::max(extent.pushable_radius, type.obstacle.radius);
  }
  extent.push_reach = 2 * static_cast<double>(limit) * extent.pushable_radius;
  return extent;
}

/// A carried body is up to `radius` away from its place.
double Halo::Extent::of_sensing() const { return reach + shift + (has_trees ? 2 : 1) * radius; }

double Halo::Extent::zone(double longest) const { return longest + radius + push_reach + k_slack_m; }

double Halo::Extent::of_motions(double longest) const {
  return std::max(2 * radius + 2 * longest, has_pushable ? 3 * zone(longest) + pushable_radius : 0.0);
}

double Halo::Extent::of_all(double longest) const {
  return std::max(of_sensing() + 2 * longest, of_motions(longest)) + k_slack_m;
}

}  // namespace troupe::engine
