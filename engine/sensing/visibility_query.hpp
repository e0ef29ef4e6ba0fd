#pragma once

#include "engine/sensing/sight.hpp"
#include "partition/near_circles.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace troupe::engine {

/// A ray from the origin of a VisibilityQuery.
struct SightLine {
  Vec2 direction = Vec2::UnitX();  ///< direction, world frame, unit length
  /// Length, m. It must be at most the argument `reach` of VisibilityQuery::stand(). Surfaces at this
  /// distance or farther are not hit.
  double length = 0;
  /// Row (index in the state tables) of a body that the ray passes through, together with the bodies that
  /// move with it (SensingView::same_tree()). Not valid(): there is no such body.
  Row target = {};
};

/// Casts many horizontal rays from one origin. The results equal, bit for bit, those of engine::first_met()
/// for rays that every part of a body stops (SightRay::stops is null). For several rays, this class is
/// faster: it looks up the bodies near the origin once for all rays, whereas engine::first_met() searches the
/// spatial index along each ray.
///
/// Call stand() before all other functions. Not thread-safe. Keep one object per thread and reuse it: its
/// arrays keep their memory.
class VisibilityQuery {
 public:
  /// Sets the origin (world frame, m) and looks up the bodies near it. Until the last ray is cast, the view
  /// must exist and the world must not change.
  ///
  /// reach: the largest ray length, m
  /// own: row of a body that all rays pass through, together with the bodies that move with it; normally the
  /// body of the sensor; not valid(): there is no such body
  /// z: height of all rays, world frame, m; not set: the rays hit surfaces at any height
  void stand(const SensingView& view, const Vec2& origin, double reach, Row own, std::optional<double> z);

  /// Rows (indices in the state tables) of the bodies whose enclosing circles reach into a disc. The centre
  /// of the disc is the origin, and its radius is the argument `reach` of stand(). Each row is listed once.
  /// Some bodies slightly outside the disc are listed too. The body `own` (see stand()) and the bodies that
  /// move with it (SensingView::same_tree()) are not listed.
  std::span<const std::uint32_t> bodies() const { return {near_.circles().row.data(), bodies_}; }

  /// Calls visit(chain) for the outlines of the bodies in bodies(), and for pieces (sections) of the outlines
  /// of static bodies. All outlines of a body have one enclosing circle, and each piece has one or more
  /// circles of its own. An outline or piece is visited if its circle reaches into the disc that bodies()
  /// describes, and if wanted(x, y, radius) is true for the circle. x and y are the centre of the circle
  /// relative to the origin, along the axes of the world frame, m. The argument `z` of stand() is ignored:
  /// outlines at all heights are visited. A piece may be visited several times.
  template <class Wanted, class Visit>
  void for_each_chain(Wanted&& wanted, Visit&& visit) {
    if (reach_ > fixed_reach_) find_fixed(reach_);
    const partition::CircleArrays& circles = near_.circles();
    for (std::size_t i = 0; i < near_.size(); ++i)
      if (wanted(circles.x[i], circles.y[i], circles.radius[i])) visit_chains(circles.row[i], visit);
  }

  /// Sets found[i] to the first surface that rays[i] hits. If this ray hits nothing, found[i].range_m is the
  /// length of the ray, and found[i].met() is false. Both spans must have the same size.
  void first_met(std::span<const SightLine> rays, std::span<RayHit> found);
  /// Calls stand() with the length of the longest ray, and then first_met(). For few long rays, it calls
  /// engine::first_met() for each ray instead, which then is faster. bodies() and for_each_chain() must not
  /// be called before the next call of stand().
  void first_met(const SensingView& view, const Vec2& origin, Row own, std::optional<double> z,
                 std::span<const SightLine> rays, std::span<RayHit> found);

 private:
  struct Hit {
    float near;  // lower bound on the distance to a surface in the circle, m
    std::uint32_t mark;
  };
  // The mark of a circle says what it encloses. It is the row of a body, or the index of a static outline
  // piece plus one of these flags, which are larger than any row.
  static constexpr std::uint32_t k_seen = 1u << 31;    // index into StaticScene::outlines()
  static constexpr std::uint32_t k_hidden = 1u << 30;  // index into StaticScene::hidden_outlines()
  /// Calls visit(chain) for what the circle with this mark encloses: for all outlines of a body, or for one
  /// piece of a static outline.
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
  void sort_into_sectors();
  RayHit search_along(const SightLine& ray) const;
  RayHit first_met(const SightLine& ray, const partition::CircleArrays& circles, std::size_t first,
                   std::size_t end);
  std::size_t find_hits(const SightLine& ray, const partition::CircleArrays& circles, std::size_t first,
                        std::size_t end);
  void meet(std::uint32_t mark, const SightLine& ray, RayHit& nearest) const;

  const SensingView* view_ = nullptr;
  Vec2 origin_ = Vec2::Zero();
  double reach_ = 0;
  Row own_;
  std::optional<double> z_;
  partition::NearCircles near_;  // bodies, then pieces of the static scene
  std::size_t bodies_ = 0;
  double fixed_reach_ = 0;  // pieces of the static scene are listed up to this distance, m; negative: none
  // For many rays: the directions are divided into sectors, and each sector has the circles that reach into
  // it.
  static constexpr std::size_t k_sectors_per_quarter = 8;
  static constexpr std::size_t k_sectors = 4 * k_sectors_per_quarter;
  struct Reach {
    std::uint8_t first;  // the first sector that a circle reaches into, counter-clockwise
    std::uint8_t count;
  };
  std::vector<Reach> reaches_;                         // per circle
  std::array<std::uint32_t, k_sectors + 1> begins_{};  // per sector, and one past the end: index into sorted_
  partition::CircleArrays sorted_;                     // by sector
  std::vector<float> distances_;                       // one per circle
  std::vector<Hit> hits_;
};

}  // namespace troupe::engine
