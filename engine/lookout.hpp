#pragma once

#include "engine/sight.hpp"
#include "partition/ranging.hpp"

#include <array>
#include <optional>
#include <span>

namespace troupe::engine {

/// A ray from where a Lookout stands.
struct SightLine {
  Vec2 direction = Vec2::UnitX();  ///< world frame, of length 1
  double length = 0;               ///< m; what is as far or farther is not met
};

/// What stands about a point, looked up once for all rays that a sensor casts from there. Each meets what
/// first_met() finds, bit for bit: that walks along every ray through the grid, while here the circles of all
/// that is near are held against up to 32 rays at a time, by the kernel that culls for rangers, and edges are
/// met in doubles as there.
/// A thread keeps one: its arrays only grow.
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
  void find_fixed(double reach);
  void fan_out(std::span<const SightLine> rays, std::span<Sighting> found, double longest);
  void look(float low, float high);
  void meet(const OutlineChain& chain, partition::BeamSet rays);

  const World* world_ = nullptr;
  Vec2 origin_ = Vec2::Zero();
  std::optional<double> z_;
  partition::CircleArrays circles_;  // of bodies, then of pieces of what never moves, marked
  std::size_t bodies_ = 0;
  std::size_t size_ = 0;
  double fixed_reach_ = 0;  // how far out pieces are known, m; negative: not at all

  std::span<const SightLine> rays_;
  std::span<Sighting> found_;
  std::array<float, partition::k_most_beams> dx_{}, dy_{}, limits_{};
  partition::MetCircles met_;
};

}  // namespace troupe::engine
