#pragma once

#include "engine/sensing/sight.hpp"
#include "partition/near_circles.hpp"

#include <optional>
#include <span>
#include <vector>

namespace troupe::engine {

/// A ray from the origin of a VisibilityQuery.
struct SightLine {
  Vec2 direction = Vec2::UnitX();  ///< direction, world frame, unit length
  /// Length, m; surfaces at this distance or farther are not hit. At most the argument `reach` of
  /// VisibilityQuery::stand().
  double length = 0;
  /// Row of a body that the ray passes through, with the bodies that move together with it. Not valid():
  /// there is no such body.
  Row target;
};

/// Casts many horizontal rays from one origin. The results equal, bit for bit, those of engine::first_met()
/// for rays that every part of a body stops (SightRay::stops is null). engine::first_met() searches the
/// spatial index along each ray. This class looks up the bodies near the origin only once for all rays. It
/// then tests each ray against the enclosing circles of these bodies. If the ray meets a circle, it is
/// intersected with the outlines of that body, from the nearest body to the farthest. Call stand() before all
/// other functions. Not thread-safe. Keep one object per thread and reuse it: its arrays keep their memory.
class VisibilityQuery {
 public:
  /// Sets the origin (world frame, m) and looks up the bodies near it. Until the last ray is cast, the view
  /// must exist and the world must not change.
  ///
  /// reach: the largest ray length, m
  /// own: row of the sensor's body, which all rays pass through, together with the bodies that move with it;
  /// not valid(): the rays pass through no body
  /// z: height of all rays, world frame, m; not set: the rays hit surfaces at any height
  void stand(const SensingView& view, const Vec2& origin, double reach, Row own, std::optional<double> z);

  /// Rows (indices in the state tables) of the bodies whose enclosing circles reach into the disc with the
  /// radius `reach` (see stand()) about the origin. Each row is listed once. Some of the circles may be
  /// slightly outside the disc. The row `own` and the bodies that move together with it
  /// (SensingView::same_tree()) are excluded.
  std::span<const std::uint32_t> bodies() const { return {near_.circles().row.data(), bodies_}; }

  /// Calls visit(chain) for outlines of bodies and of the static scene. Visits an outline if two conditions
  /// hold: its enclosing circle reaches into the disc about the origin with the radius `reach` (see stand()),
  /// and wanted(x, y, radius) is true for the circle. x and y are the centre of the circle relative to the
  /// origin, in the directions of the world frame, m. Outlines at any height are visited, whatever the
  /// argument `z` of stand() is. A piece of the static scene may be visited several times.
  template <class Wanted, class Visit>
  void for_each_chain(Wanted&& wanted, Visit&& visit) {
    if (reach_ > fixed_reach_) find_fixed(reach_);
    const partition::CircleArrays& circles = near_.circles();
    for (std::size_t i = 0; i < near_.size(); ++i)
      if (wanted(circles.x[i], circles.y[i], circles.radius[i])) visit_chains(circles.row[i], visit);
  }

  /// Sets found[i] to the first surface that rays[i] hits. If the ray hits nothing, found[i].range_m is the
  /// length of the ray, and found[i].met() is false. Both spans must have the same size.
  void first_met(std::span<const SightLine> rays, std::span<RayHit> found);

 private:
  struct Hit {
    float near;  // lower bound on the distance to a surface in the circle, m
    std::uint32_t mark;
  };
  // The mark of a circle says what it encloses. It is the row of a body, or the index of a static outline
  // piece plus one of these flags, which are larger than any row.
  static constexpr std::uint32_t k_seen = 1u << 31;    // index into StaticScene::outlines()
  static constexpr std::uint32_t k_hidden = 1u << 30;  // index into StaticScene::hidden_outlines()
  /// Calls visit(chain) for the outlines that the circle with this mark encloses.
  template <class Visit>
  void visit_chains(std::uint32_t mark, Visit&& visit) const {
    const partition::StaticScene& scene = view_->scene();
    if ((mark & k_seen) != 0)
      visit(fixed_chain(scene, scene.outlines(), mark - k_seen));
    else if ((mark & k_hidden) != 0)
      visit(fixed_chain(scene, scene.hidden_outlines(), mark - k_hidden));
    else
      for_each_chain_of(*view_, Row(mark), visit);
  }
  void find_fixed(double reach);
  RayHit first_met(const SightLine& ray);
  std::size_t find_hits(const SightLine& ray);
  void meet(std::uint32_t mark, const SightLine& ray, RayHit& nearest) const;

  const SensingView* view_ = nullptr;
  Vec2 origin_ = Vec2::Zero();
  double reach_ = 0;
  Row own_;
  std::optional<double> z_;
  partition::NearCircles near_;  // bodies, then pieces of the static scene
  std::size_t bodies_ = 0;
  double fixed_reach_ = 0;  // pieces of the static scene are listed up to this distance, m; negative: none
  std::vector<float> distances_;  // one per circle
  std::vector<Hit> hits_;
};

}  // namespace troupe::engine
