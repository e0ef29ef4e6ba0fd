#pragma once

#include "engine/sight.hpp"
#include "partition/surroundings.hpp"

#include <optional>
#include <span>
#include <vector>

namespace troupe::engine {

/// A ray from where a Lookout stands.
struct SightLine {
  Vec2 direction = Vec2::UnitX();  ///< world frame, of length 1
  double length = 0;               ///< m; what is as far or farther is not met
};

/// What stands about a point, looked up once for all rays that a sensor casts from there. Each meets what
/// first_met() finds, bit for bit: that walks along every ray through the grid, while here all circles that
/// are near are held against it at once, and what is left is met from near to far. A thread keeps one: its
/// arrays only grow.
class Lookout {
 public:
  /// Finds the bodies. reach: no ray is longer, m; own, z: as in SightRay. The world must not change while it
  /// stands there.
  void stand(const World& world, const Vec2& origin, double reach, Row own, std::optional<double> z);

  /// The rows of bodies whose circles come within the reach, each once, and perhaps some that just do not;
  /// own tree left out.
  std::span<const std::uint32_t> bodies() const { return {circles_.row.data(), bodies_}; }

  /// found[i]: what ray i meets first. Sizes are equal.
  void first_met(std::span<const SightLine> rays, std::span<Sighting> found);

 private:
  struct Hit {
    float near;  // no surface in the circle is met nearer than this, m
    std::uint32_t mark;
  };
  void add_near(std::span<const partition::BodyCircle> run, std::uint32_t mark);
  void find_fixed(double reach);
  Sighting first_met(const SightLine& ray);
  std::size_t find_hits(const SightLine& ray);
  void meet(std::uint32_t mark, const SightLine& ray, Sighting& nearest) const;

  const World* world_ = nullptr;
  Vec2 origin_ = Vec2::Zero();
  double reach_ = 0;
  Row own_;
  std::optional<double> z_;
  partition::CircleArrays circles_;  // relative to the origin: of bodies, then of pieces of the static scene
  std::size_t bodies_ = 0;
  std::size_t size_ = 0;
  double fixed_reach_ = 0;  // how far out pieces are known, m; negative: not at all
  std::vector<float> near_;
  std::vector<Hit> hits_;
};

}  // namespace troupe::engine
