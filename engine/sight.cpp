#include "engine/sight.hpp"

#include "engine/shown_color.hpp"

#include <algorithm>
#include <cmath>

namespace troupe::engine {
namespace {

/// What culls leave beside, m: far above the rounding of doubles within the 100 km of a world.
constexpr double k_slack = 1e-9;

/// Keeps the nearest of what it is shown.
class Nearest {
 public:
  Nearest(const World& world, const SightRay& ray) : world_(world), ray_(ray), best_{.range = ray.length} {}

  const Sighting& best() const { return best_; }

  /// look(box) from near to far, a step at a time, as far as something may still be the nearest.
  template <class Look>
  void walk(double step, Look&& look) const {
    for (double i = 0; i * step <= best_.range; ++i) {
      Box box;
      box.extend(Vec2(ray_.origin + i * step * ray_.direction));
      box.extend(Vec2(ray_.origin + std::min((i + 1) * step, best_.range) * ray_.direction));
      look(box.expanded(k_slack));
    }
  }

  /// Whether the ray comes within the circle, as far as it still goes.
  bool reaches(const partition::BodyCircle& circle) const {
    const Vec2 centre = Vec2(circle.x, circle.y) - ray_.origin;
    const double along = centre.dot(ray_.direction);
    const double radius = circle.radius + k_slack;
    return std::abs(cross(centre, ray_.direction)) <= radius && along >= -radius &&
           along <= best_.range + radius;
  }

  void meet(const OutlineChain& chain) {
    if (ray_.z && !chain.z.contains(*ray_.z)) return;
    if (ray_.stops != nullptr &&
        !ray_.stops(Sighting{.body = chain.body, .part = chain.part}.part_spec(world_).returns))
      return;
    for_each_edge(chain, [&](const Vec2& a, const Vec2& b) {
      const double range = range_to_edge(ray_.origin, ray_.direction, a, b);
      if (range < 0 || range >= ray_.length || range > best_.range) return;
      const bool is_lower = chain.body != best_.body ? chain.body < best_.body : chain.part < best_.part;
      if (range < best_.range || is_lower) best_ = {range, chain.body, chain.part};
    });
  }

 private:
  const World& world_;
  const SightRay& ray_;
  Sighting best_;
};

}  // namespace

Color color_of(const World& world, const Sighting& sighting) {
  if (const Row row = world.row(sighting.body); row.valid())
    if (const std::optional<Color> shown = shown_color(world, row, sighting.part)) return *shown;
  return sighting.part_spec(world).color.value_or(world.spec().bodies[sighting.body.index()].color);
}

double range_to_edge(const Vec2& origin, const Vec2& direction, const Vec2& a, const Vec2& b) {
  constexpr double k_missed = -1;
  const Vec2 to_a = a - origin;
  const Vec2 to_b = b - origin;
  const double side_a = cross(to_a, direction);
  const double side_b = cross(to_b, direction);
  if (std::min(side_a, side_b) > 0 || std::max(side_a, side_b) < 0) return k_missed;
  const double along_a = to_a.dot(direction);
  const double along_b = to_b.dot(direction);
  const double near = std::min(along_a, along_b);
  const double far = std::max(along_a, along_b);
  if (side_a == side_b) return far < 0 ? k_missed : std::max(near, 0.0);  // the edge runs along the ray
  const double range = along_a + side_a / (side_a - side_b) * (along_b - along_a);
  return std::clamp(range, near, far) < 0 ? k_missed : std::clamp(range, near, far);
}

Sighting first_met(const World& world, const SightRay& ray) {
  Nearest nearest(world, ray);
  const auto wanted = [&](const partition::BodyCircle& circle) { return nearest.reaches(circle); };
  const auto meet = [&](const OutlineChain& chain) { nearest.meet(chain); };
  // What never moves first: where there is a wall, nobody asks for the bodies behind it.
  nearest.walk(world.scene().outlines().geometry().cell_m,
               [&](const Box& box) { for_each_fixed_chain(world, box, wanted, meet); });
  nearest.walk(2 * world.geometry().cell_m,
               [&](const Box& box) { for_each_body_chain(world, box, ray.own, wanted, meet); });
  return nearest.best();
}

}  // namespace troupe::engine
