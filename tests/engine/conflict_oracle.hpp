#pragma once

#include "base/random.hpp"
#include "engine/conflicts/conflicts.hpp"
#include "tests/engine/oracle_polygons.hpp"

#include <optional>
#include <span>
#include <vector>

namespace troupe::oracle {

/// The shape of a body for this oracle: its blocks, and the smallest width (m) of the convex pieces into
/// which the engine divides them. The width determines the steps in which the oracle tests a motion.
struct Body {
  std::vector<Solid> blocks;  ///< body frame, m
  double thinnest = 0;        ///< smallest width of a convex piece, m
};

/// Returns the width of a convex polygon: its smallest extent in any direction, m. The smallest extent is
/// always along the normal of one of the edges.
inline double thickness(const Ring& ring) {
  double least = 1e300;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec2 edge = ring[(i + 1) % ring.size()] - ring[i];
    const Vec2 normal = Vec2(-edge.y(), edge.x()) / std::hypot(edge.x(), edge.y());
    double low = 1e300;
    double high = -1e300;
    for (const Vec2& v : ring) {
      low = std::min(low, normal.dot(v));
      high = std::max(high, normal.dot(v));
    }
    least = std::min(least, high - low);
  }
  return least;
}

struct Motion {
  Pose from;
  Pose to;
  double turn = 0;
  bool moves = false;
};

inline std::vector<Pose> poses_of_motion(const Motion& m, const Body& body) {
  double radius = 0;
  for (const Solid& block : body.blocks)
    for (const Ring& ring : block.contours)
      for (const Vec2& v : ring) radius = std::max(radius, std::hypot(v.x(), v.y()));
  const double displacement = std::hypot(m.to.x - m.from.x, m.to.y - m.from.y) + radius * std::abs(m.turn);
  const double n = std::max(1.0, std::ceil(displacement / (body.thinnest / 4)));
  std::vector<Pose> poses;
  for (double k = 1; k < n; ++k)
    poses.push_back({m.from.x + (m.to.x - m.from.x) * (k / n), m.from.y + (m.to.y - m.from.y) * (k / n),
                     m.from.z + (m.to.z - m.from.z) * (k / n), m.from.heading + m.turn * (k / n)});
  poses.push_back(m.to);
  return poses;
}

struct Question {
  std::span<const Motion> motions;
  std::span<const Body* const> bodies;
  std::span<const std::uint32_t> ids;
  std::span<const Solid> walls;  ///< solids that block bodies, world frame, m
  std::uint64_t seed = 1;
  std::uint64_t tick = 0;
  std::optional<Box> bounds;
};

/// Computes the outcomes of the motions in the simplest way: one body after the other, in the order of their
/// priorities (a hash of seed, tick and id), without a spatial index and without threads. Tests compare the
/// outcomes with those of the engine. by_priority: false moves the bodies in the order of their ids instead,
/// which is wrong. Tests use this to check that the order matters for their crowds.
inline std::vector<engine::Conflicts::Outcome> resolve(const Question& q, bool by_priority = true) {
  using enum engine::Conflicts::Outcome;
  const auto squared = [](double x, double y) { return x * x + y * y; };
  const std::size_t count = q.motions.size();
  std::vector<std::size_t> order(count);
  for (std::size_t i = 0; i < count; ++i) order[i] = i;
  if (by_priority)
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return mix(q.seed, q.tick, q.ids[i]); });

  std::vector<Blocks> walls;
  for (const Solid& wall : q.walls) walls.push_back(place({wall}, {}));
  std::vector<Pose> now;
  std::vector<Blocks> placed;
  for (std::size_t i = 0; i < count; ++i) {
    now.push_back(q.motions[i].from);
    placed.push_back(place(q.bodies[i]->blocks, now[i]));
  }

  std::vector<engine::Conflicts::Outcome> outcomes(count, stands);
  for (const std::size_t i : order) {
    const Motion& m = q.motions[i];
    if (!m.moves) continue;
    const Box all = q.bounds.value_or(Box{Vec2(-1e300, -1e300), Vec2(1e300, 1e300)});
    if (m.to.x < all.min.x() || m.to.x > all.max.x() || m.to.y < all.min.y() || m.to.y > all.max.y()) {
      outcomes[i] = out_of_bounds;
      continue;
    }
    outcomes[i] = moved;
    Blocks there;
    for (const Pose& pose : poses_of_motion(m, *q.bodies[i])) {
      there = place(q.bodies[i]->blocks, pose);
      for (const Blocks& wall : walls)
        if (overlap(there, wall) && !overlap(placed[i], wall)) outcomes[i] = blocked;
      for (std::size_t o = 0; o < count; ++o) {
        if (o == i || !overlap(there, placed[o])) continue;
        const bool apart =
            squared(m.to.x - now[o].x, m.to.y - now[o].y) > squared(m.from.x - now[o].x, m.from.y - now[o].y);
        if (!apart || !overlap(placed[i], placed[o])) outcomes[i] = blocked;
      }
      if (outcomes[i] == blocked) break;
    }
    if (outcomes[i] == blocked) continue;
    now[i] = m.to;
    placed[i] = std::move(there);
  }
  return outcomes;
}

}  // namespace troupe::oracle
