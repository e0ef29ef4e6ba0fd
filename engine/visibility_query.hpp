#pragma once

#include "engine/sight.hpp"
#include "partition/nearby_outlines.hpp"

#include <optional>
#include <span>
#include <vector>

namespace troupe::engine {

/// A ray from the origin of a VisibilityQuery.
struct SightLine {
  Vec2 direction = Vec2::UnitX();  ///< world frame, unit length
  double length = 0;               ///< length, m; outlines at this distance or farther are not hit
};

/// Casts many rays from one origin. The results equal those of engine::first_met() bit for bit. That function
/// walks along each ray through the grid. This class instead looks up the bodies near the origin once for all
/// rays, tests each ray against the enclosing circles of these bodies, and intersects the remaining
/// candidates from near to far. Not thread-safe. Keep one object per thread and reuse it: its arrays keep
/// their memory.
class VisibilityQuery {
 public:
  /// Sets the origin (world frame, m) and looks up the bodies near it. The world must not change until the
  /// last ray is cast.
  ///
  /// reach: the largest ray length, m
  /// own, z: as in SightRay; they hold for all rays
  void stand(const World& world, const Vec2& origin, double reach, Row own, std::optional<double> z);

  /// Rows of the bodies whose enclosing circles reach into the disc with the radius `reach` about the origin,
  /// each once. Some circles may be slightly outside it. The row `own` and the bodies that move together with
  /// it (World::same_tree()) are excluded.
  std::span<const std::uint32_t> bodies() const { return {circles_.row.data(), bodies_}; }

  /// Sets found[i] to the first surface that rays[i] hits. Both spans must have the same size.
  void first_met(std::span<const SightLine> rays, std::span<RayHit> found);

 private:
  struct Hit {
    float near;  // lower bound on the distance to a surface in the circle, m
    std::uint32_t mark;
  };
  void add_near(std::span<const partition::BodyCircle> run, std::uint32_t mark);
  void find_fixed(double reach);
  RayHit first_met(const SightLine& ray);
  std::size_t find_hits(const SightLine& ray);
  void meet(std::uint32_t mark, const SightLine& ray, RayHit& nearest) const;

  const World* world_ = nullptr;
  Vec2 origin_ = Vec2::Zero();
  double reach_ = 0;
  Row own_;
  std::optional<double> z_;
  partition::CircleArrays circles_;  // relative to the origin: bodies, then pieces of the static scene
  std::size_t bodies_ = 0;
  std::size_t size_ = 0;
  double fixed_reach_ = 0;  // pieces of the static scene are listed up to this distance, m; negative: none
  std::vector<float> near_;
  std::vector<Hit> hits_;
};

}  // namespace troupe::engine
