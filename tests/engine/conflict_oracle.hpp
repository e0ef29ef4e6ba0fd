#pragma once

#include "base/random.hpp"
#include "engine/conflicts/conflicts.hpp"
#include "tests/engine/oracle_polygons.hpp"

#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace troupe::oracle {

/// The shape of a body for this oracle: its blocks, the convex pieces into which the engine divides them, and
/// the smallest width of these. The width determines the steps in which the oracle tests a motion.
struct Body {
  std::vector<Solid> blocks;        ///< body frame, m
  std::vector<ConvexPrism> pieces;  ///< body frame, m
  double thinnest = 0;              ///< smallest width of a convex piece, m
};

/// Returns the corners of an outline (body frame, m) of a body at this pose, in the world frame, m.
inline std::vector<Vec2> corners(const Ring& outline, const Pose& pose) {
  std::vector<Vec2> out;
  const double c = std::cos(pose.heading);
  const double s = std::sin(pose.heading);
  for (const Vec2& v : outline)
    out.emplace_back(pose.x + c * v.x() - s * v.y(), pose.y + s * v.x() + c * v.y());
  return out;
}

/// Returns the depth of two convex polygons in each other, m: the distance from the origin to the border of
/// the set of the differences of their points, if the origin is in this set, and otherwise 0.
inline double depth(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
  std::vector<Vec2> differences;
  for (const Vec2& p : a)
    for (const Vec2& q : b) differences.emplace_back(p.x() - q.x(), p.y() - q.y());
  std::ranges::sort(differences, {}, [](const Vec2& v) { return std::pair(v.x(), v.y()); });
  const auto turn = [](const Vec2& p, const Vec2& q, const Vec2& r) {
    return (q.x() - p.x()) * (r.y() - p.y()) - (q.y() - p.y()) * (r.x() - p.x());
  };
  std::vector<Vec2> hull;
  for (int half = 0; half < 2; ++half) {  // the lower half from left to right, then the upper half back
    const std::size_t begin = hull.size();
    for (const Vec2& v : differences) {
      while (hull.size() >= begin + 2 && turn(hull[hull.size() - 2], hull.back(), v) <= 0) hull.pop_back();
      hull.push_back(v);
    }
    hull.pop_back();
    std::ranges::reverse(differences);
  }
  double least = 1e300;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2& p = hull[i];
    const Vec2& q = hull[(i + 1) % hull.size()];
    least = std::min(least, turn(p, q, Vec2(0, 0)) / std::hypot(q.x() - p.x(), q.y() - p.y()));
  }
  return std::max(least, 0.0);
}

/// Whether the motion of a body from one pose to another takes a piece of it deeper into one of the pieces
/// `others` of a body at the pose `at`. What may be rounding does not count: 1e-12 m, and any depth up to
/// 1e-9 m if the pieces overlapped before.
inline bool goes_deeper(const std::vector<ConvexPrism>& pieces, const Pose& from, const Pose& to,
                        const std::vector<ConvexPrism>& others, const Pose& at) {
  for (const ConvexPrism& piece : pieces)
    for (const ConvexPrism& other : others) {
      const auto depth_at = [&](const Pose& pose) {
        const bool shares_height = std::max(piece.z.min + pose.z, other.z.min + at.z) <
                                   std::min(piece.z.max + pose.z, other.z.max + at.z);
        return shares_height ? depth(corners(piece.outline, pose), corners(other.outline, at)) : 0;
      };
      const double before = depth_at(from);
      const double after = depth_at(to);
      if (after > 0 && (before == 0 || after > std::max(before + 1e-12, 1e-9))) return true;
    }
  return false;
}

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
  std::span<const std::uint8_t> turns = {};  ///< 1: a body that turns on the spot if its motion is blocked
};

/// Whether body i turns on the spot if its motion is blocked, and the motion with which it does so.
inline bool may_turn(const Question& q, std::size_t i) {
  const Motion& m = q.motions[i];
  return !q.turns.empty() && q.turns[i] != 0 && m.turn != 0 && (m.to.x != m.from.x || m.to.y != m.from.y);
}
inline Motion turn_of(const Motion& m) {
  return {m.from, {m.from.x, m.from.y, m.from.z, m.to.heading}, m.turn, true};
}

/// Computes the outcomes of the motions in the simplest way: one body after the other, in the order of their
/// priorities (a hash of seed, tick and id), without a spatial index and without threads. Tests compare the
/// outcomes with those of the engine. by_priority: false moves the bodies in the order of their ids instead,
/// which is wrong. Tests use this to check that the order matters for their crowds. contacts: if not null,
/// receives what blocked each body; the id of a wall is its index.
inline std::vector<engine::Conflicts::Outcome> resolve(const Question& q, bool by_priority = true,
                                                       std::vector<engine::Contact>* contacts = nullptr) {
  using engine::Contact;
  using enum engine::Conflicts::Outcome;
  const std::size_t count = q.motions.size();
  std::vector<std::size_t> order(count);
  for (std::size_t i = 0; i < count; ++i) order[i] = i;
  if (by_priority)
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return mix(q.seed, q.tick, q.ids[i]); });

  std::vector<Blocks> walls;
  std::vector<std::vector<ConvexPrism>> wall_pieces;
  for (const Solid& wall : q.walls) {
    walls.push_back(place({wall}, {}));
    wall_pieces.push_back(convex_pieces(wall));
  }
  std::vector<Pose> now;
  std::vector<Blocks> placed;
  for (std::size_t i = 0; i < count; ++i) {
    now.push_back(q.motions[i].from);
    placed.push_back(place(q.bodies[i]->blocks, now[i]));
  }

  std::vector<engine::Conflicts::Outcome> outcomes(count, stands);
  if (contacts != nullptr) contacts->assign(count, {});
  for (const std::size_t i : order) {
    const Motion& m = q.motions[i];
    if (!m.moves) continue;
    const Box all = q.bounds.value_or(Box{Vec2(-1e300, -1e300), Vec2(1e300, 1e300)});
    if (m.to.x < all.min.x() || m.to.x > all.max.x() || m.to.y < all.min.y() || m.to.y > all.max.y()) {
      outcomes[i] = out_of_bounds;
      if (contacts != nullptr) (*contacts)[i].cause = Contact::k_bounds;
      continue;
    }
    const std::vector<ConvexPrism>& pieces = q.bodies[i]->pieces;
    Blocks there;
    Contact contact;
    const auto is_free = [&](const Motion& motion) {
      Pose last = m.from;
      there = placed[i];
      for (const Pose& pose : poses_of_motion(motion, *q.bodies[i])) {
        const Blocks before = std::exchange(there, place(q.bodies[i]->blocks, pose));
        const auto forbids = [&](const Blocks& other, const std::vector<ConvexPrism>& its, const Pose& at) {
          return overlap(there, other) &&
                 (!overlap(before, other) || goes_deeper(pieces, last, pose, its, at));
        };
        std::vector<std::uint32_t> by;  // the ids of the walls in the way or, if there are none, of bodies
        for (std::size_t w = 0; w < walls.size(); ++w)
          if (forbids(walls[w], wall_pieces[w], {})) by.push_back(static_cast<std::uint32_t>(w));
        const bool is_walled = !by.empty();
        for (std::size_t o = 0; o < count && !is_walled; ++o)
          if (o != i && forbids(placed[o], q.bodies[o]->pieces, now[o])) by.push_back(q.ids[o]);
        if (!by.empty()) {
          contact = {Contact::k_body, std::ranges::min(by) + 1, 0};
          return false;
        }
        last = pose;
      }
      return true;
    };
    const Motion turn = turn_of(m);
    outcomes[i] = is_free(m) ? moved : blocked;
    if (contacts != nullptr) (*contacts)[i] = contact;
    if (outcomes[i] == blocked && may_turn(q, i) && is_free(turn)) outcomes[i] = turned;
    if (outcomes[i] == blocked) continue;
    now[i] = outcomes[i] == moved ? m.to : turn.to;
    placed[i] = std::move(there);
  }
  return outcomes;
}

}  // namespace troupe::oracle
