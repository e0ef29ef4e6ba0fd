#include "engine/sensing/sight.hpp"

#include "engine/sensing/shown_color.hpp"

#include <algorithm>
#include <cmath>

namespace troupe::engine {
namespace {

/// Margin for tests that exclude surfaces early, m: far above the rounding errors of doubles within 100 km of
/// the origin.
constexpr double k_margin_m = 1e-9;

/// Finds the nearest surface that a ray hits among the outlines that are passed to meet().
class Nearest {
 public:
  Nearest(const SensingView& view, const SightRay& ray)
      : view_(view), ray_(ray), best_{.range_m = ray.length} {}

  const RayHit& best() const { return best_; }

  /// Divides the ray into consecutive pieces of length `step`, m, and calls visit(box) with the bounding box
  /// of each. Ends at the nearest surface found so far.
  template <class Visit>
  void walk(double step, Visit&& visit) const {
    for (double i = 0; i * step <= best_.range_m; ++i) {
      Box box;
      box.extend(Vec2(ray_.origin + i * step * ray_.direction));
      box.extend(Vec2(ray_.origin + std::min((i + 1) * step, best_.range_m) * ray_.direction));
      visit(box.expanded(k_margin_m));
    }
  }

  /// Whether the ray passes through the row's body because this body moves with SightRay::target.
  bool passes(Row row) const { return ray_.target.valid() && view_.same_tree(row, ray_.target); }

  /// Whether the ray reaches the circle before the nearest surface found so far.
  bool reaches(const partition::BodyCircle& circle) const {
    const Vec2 centre = Vec2(circle.x, circle.y) - ray_.origin;
    const double along = centre.dot(ray_.direction);
    const double radius = circle.radius + k_margin_m;
    return std::abs(cross(centre, ray_.direction)) <= radius && along >= -radius &&
           along <= best_.range_m + radius;
  }

  void meet(const OutlineChain& chain) {
    if (ray_.z && !chain.z.contains(*ray_.z)) return;
    if (ray_.stops != nullptr &&
        !ray_.stops(part_of(view_, {.body = chain.body, .part = chain.part}).returns))
      return;
    meet_chain(chain, ray_.origin, ray_.direction, ray_.length, best_);
  }

 private:
  const SensingView& view_;
  const SightRay& ray_;
  RayHit best_;
};

}  // namespace

Color color_of(const CommittedView& view, const RayHit& hit) {
  if (const Row row = view.row(hit.body); row.valid())
    if (const std::optional<Color> shown = shown_color(view, row, hit.part)) return *shown;
  return part_of(view, hit).color.value_or(view.spec().bodies[hit.body.index()].color);
}

RayHit first_met(const SensingView& view, const SightRay& ray) {
  Nearest nearest(view, ray);
  const auto wanted = [&](const partition::BodyCircle& circle) { return nearest.reaches(circle); };
  const auto wanted_body = [&](const partition::BodyCircle& circle) {
    return nearest.reaches(circle) && !nearest.passes(Row(circle.row));
  };
  const auto meet = [&](const OutlineChain& chain) { nearest.meet(chain); };
  // The static scene first, so that bodies behind a wall need no lookup.
  nearest.walk(view.scene().outlines().geometry().cell_m,
               [&](const Box& box) { for_each_fixed_chain(view, box, wanted, meet); });
  nearest.walk(2 * view.geometry().cell_m,
               [&](const Box& box) { for_each_body_chain(view, box, ray.own, wanted_body, meet); });
  return nearest.best();
}

}  // namespace troupe::engine
