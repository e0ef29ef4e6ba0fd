#pragma once

#include "tests/engine/conflict_oracle.hpp"

#include <limits>
#include <numeric>
#include <optional>
#include <vector>

namespace troupe::oracle {

/// The input of resolve_pushing(): the bodies and their motions (`base`), and the data that pushing needs in
/// addition. The other members have one entry per body, in the order of base.bodies.
struct PushQuestion {
  Question base;
  std::vector<bool> pushable;       ///< whether robots can push the body
  std::vector<std::size_t> limits;  ///< largest number of bodies that the body can push at once
};

struct PushAnswer {
  std::vector<engine::Conflicts::Outcome> outcomes;
  std::vector<Pose> poses;
  std::vector<engine::Contact> contacts;  ///< what blocked each body; the id of a wall is its index
  std::size_t shifts = 0;    ///< number of pushes: a robot pushes a body, directly or through other bodies
  std::size_t chained = 0;   ///< number of pushes through other bodies
  std::size_t again = 0;     ///< number of pushes of a body that another robot pushed before in the tick
  std::size_t stopped = 0;   ///< motions blocked because the bodies in the way could not be pushed
  std::size_t too_many = 0;  ///< motions blocked because they would push more bodies than the limit
};

/// The interval that a set of points covers when it is projected on an axis, m.
struct Shadow {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};
inline Shadow shadow(const std::vector<Vec2>& points, const Vec2& along) {
  Shadow out;
  for (const Vec2& p : points) {
    const double at = p.x() * along.x() + p.y() * along.y();
    out.low = std::min(out.low, at);
    out.high = std::max(out.high, at);
  }
  return out;
}

/// Returns the vector (world frame, m) by which body b must be shifted to leave body a. Both bodies consist
/// of convex pieces. For each pair of overlapping pieces, the function computes the shortest shift along the
/// normal of an edge that separates the two pieces. The result is the longest of these shifts, or
/// std::nullopt if no pieces overlap.
inline std::optional<Vec2> leave(const std::vector<ConvexPrism>& a, const Pose& at_a,
                                 const std::vector<ConvexPrism>& b, const Pose& at_b) {
  double farthest = 0;
  Vec2 way(0, 0);
  for (const ConvexPrism& p : a) {
    for (const ConvexPrism& q : b) {
      if (std::min(p.z.max + at_a.z, q.z.max + at_b.z) <= std::max(p.z.min + at_a.z, q.z.min + at_b.z))
        continue;
      const std::vector<Vec2> of_a = corners(p.outline, at_a);
      const std::vector<Vec2> of_b = corners(q.outline, at_b);
      double shortest = std::numeric_limits<double>::infinity();
      Vec2 out(0, 0);
      for (const auto* ring : {&of_a, &of_b}) {
        for (std::size_t i = 0; i < ring->size(); ++i) {
          const Vec2 edge =
              (*ring)[(i + ring->size()) % ring->size()] - (*ring)[(i + ring->size() - 1) % ring->size()];
          const Vec2 normal = Vec2(edge.y(), -edge.x()) / std::hypot(edge.x(), edge.y());
          const Vec2 along = ring == &of_a ? normal : Vec2(-normal.x(), -normal.y());
          const double depth = shadow(of_a, along).high - shadow(of_b, along).low;
          if (depth < shortest) {
            shortest = depth;
            out = along;
          }
        }
      }
      if (shortest > farthest) {
        farthest = shortest;
        way = out * shortest;
      }
    }
  }
  if (farthest == 0) return {};
  return way;
}

/// Returns the distance from the origin of a body to its farthest vertex, m.
inline double radius_of(const std::vector<ConvexPrism>& pieces) {
  double radius = 0;
  for (const ConvexPrism& piece : pieces)
    for (const Vec2& v : piece.outline) radius = std::max(radius, std::hypot(v.x(), v.y()));
  return radius;
}

/// Computes the outcomes of the motions by the rule of docs/pushing.md in the simplest way, one body after
/// the other. Tests compare the result with that of the engine. If an argument is false, a wrong rule is
/// used; tests use this to check that the rule matters for their crowds. by_priority: false moves the bodies
/// in the order of their ids. only_near: false lets robots also push bodies that were too far away before the
/// tick and were pushed near in the same tick.
inline PushAnswer resolve_pushing(const PushQuestion& question, bool by_priority = true,
                                  bool only_near = true) {
  using enum engine::Conflicts::Outcome;
  using engine::Contact;
  const Question& q = question.base;
  const std::size_t count = q.motions.size();
  const auto squared = [](const Pose& a, const Pose& b) {
    return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
  };
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  if (by_priority)
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return mix(q.seed, q.tick, q.ids[i]); });
  std::vector<std::size_t> by_id(count);
  std::iota(by_id.begin(), by_id.end(), 0);
  std::ranges::sort(by_id, {}, [&](std::size_t i) { return q.ids[i]; });
  double thinnest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count; ++i)
    if (question.pushable[i]) thinnest = std::min(thinnest, q.bodies[i]->thinnest);
  std::vector<double> radii;
  for (const Body* body : q.bodies) radii.push_back(radius_of(body->pieces));
  double largest = 0;  // radius of a pushable body
  for (std::size_t i = 0; i < count; ++i)
    if (question.pushable[i]) largest = std::max(largest, radii[i]);
  /// Whether, before the tick, a pushable body was in the circle around robot i that contains everything that
  /// the robot could push in the tick.
  const auto has_something_near = [&](std::size_t i) {
    const double zone = std::sqrt(squared(q.motions[i].from, q.motions[i].to)) + radii[i] +
                        2 * static_cast<double>(question.limits[i]) * largest + 1e-6;
    for (std::size_t o = 0; o < count; ++o)
      if (question.pushable[o] && std::sqrt(squared(q.motions[i].from, q.motions[o].from)) <= zone + radii[o])
        return true;
    return false;
  };

  std::vector<Blocks> walls;
  std::vector<std::vector<ConvexPrism>> wall_pieces;
  for (const Solid& wall : q.walls) {
    walls.push_back(place({wall}, {}));
    wall_pieces.push_back(convex_pieces(wall));
  }
  const Box all = q.bounds.value_or(Box{Vec2(-1e300, -1e300), Vec2(1e300, 1e300)});
  const auto outside = [&](const Pose& p) {
    return p.x < all.min.x() || p.x > all.max.x() || p.y < all.min.y() || p.y > all.max.y();
  };

  PushAnswer answer{std::vector(count, stands), {}, std::vector<Contact>(count)};
  std::vector<Pose>& now = answer.poses;
  std::vector<Blocks> placed;
  for (std::size_t i = 0; i < count; ++i) {
    now.push_back(q.motions[i].from);
    placed.push_back(place(q.bodies[i]->blocks, now[i]));
  }
  std::vector<bool> touched(count);
  const auto body = [&](std::size_t i, const Pose& pose) { return place(q.bodies[i]->blocks, pose); };
  /// Whether body o, at its present pose, or a wall forbids that body i goes from one sample to the next:
  /// from the pose `from`, where its blocks are `before`, to the pose `to`, where they are `there`.
  const auto forbids = [&](std::size_t o, std::size_t i, const Pose& from, const Blocks& before,
                           const Pose& to, const Blocks& there) {
    return overlap(there, placed[o]) &&
           (!overlap(before, placed[o]) ||
            goes_deeper(q.bodies[i]->pieces, from, to, q.bodies[o]->pieces, now[o]));
  };
  /// What forbids that body i goes from one sample to the next, as an id plus 1: the first wall, otherwise
  /// the body with the lowest id for which `counts` is true. 0: nothing.
  const auto in_way = [&](std::size_t i, const Pose& from, const Blocks& before, const Pose& to,
                          const Blocks& there, auto&& counts) -> std::uint32_t {
    for (std::size_t w = 0; w < walls.size(); ++w)
      if (overlap(there, walls[w]) &&
          (!overlap(before, walls[w]) || goes_deeper(q.bodies[i]->pieces, from, to, wall_pieces[w], {})))
        return static_cast<std::uint32_t>(w) + 1;
    for (const std::size_t o : by_id)
      if (o != i && counts(o) && forbids(o, i, from, before, to, there)) return q.ids[o] + 1;
    return 0;
  };

  for (const std::size_t i : order) {
    const Motion& m = q.motions[i];
    if (!m.moves) continue;
    if (outside(m.to)) {
      answer.outcomes[i] = out_of_bounds;
      answer.contacts[i].cause = Contact::k_bounds;
      continue;
    }
    std::vector<bool> gives_way(count);
    const bool may_push = question.limits[i] > 0 && (!only_near || has_something_near(i));
    for (std::size_t o = 0; o < count; ++o)
      gives_way[o] = may_push && question.pushable[o] && !overlap(placed[i], placed[o]);
    double free_part = 1;  // of the motion, before the sample at which is_free() has found it blocked
    std::uint32_t by = 0;  // what blocks it there, as an id plus 1
    /// Whether the motion is free of the walls, and of all bodies that do not give way or, if it pushes
    /// nothing, of all bodies.
    const auto is_free = [&](const Motion& motion, bool pushes) {
      Pose last = m.from;
      Blocks there = placed[i];
      const std::vector<Pose> samples = poses_of_motion(motion, *q.bodies[i]);
      for (std::size_t k = 0; k < samples.size(); ++k) {
        const Blocks before = std::exchange(there, body(i, samples[k]));
        by = in_way(i, last, before, samples[k], there,
                    [&](std::size_t o) { return !pushes || !gives_way[o]; });
        free_part = static_cast<double>(k + 1) / static_cast<double>(samples.size());
        if (by != 0) return false;
        last = samples[k];
      }
      return true;
    };
    const auto turn_or_block = [&] {
      answer.outcomes[i] = blocked;
      if (!may_turn(q, i)) return;
      const Motion turn = turn_of(m);
      if (!is_free(turn, false)) return;
      answer.outcomes[i] = turned;
      now[i] = turn.to;
      placed[i] = body(i, turn.to);
    };
    const bool is_own_way_free = is_free(m, true);
    if (!is_own_way_free) answer.contacts[i] = {Contact::k_body, by, 0};

    std::vector<std::size_t> pushed;  // in the order in which they are met
    std::vector<Pose> to = now;
    std::vector<Blocks> at = placed;
    std::size_t shifts = 0;
    std::size_t chained = 0;
    bool too_many = false;
    Contact stop{Contact::k_pushed, 0, 0};
    /// Pushes until the own way is blocked.
    const auto push = [&] {
      Body fine = *q.bodies[i];
      fine.thinnest = std::min(fine.thinnest, thinnest);
      const std::vector<Pose> samples = poses_of_motion(m, fine);
      for (std::size_t k = 0; k < samples.size(); ++k) {
        const Pose& pose = samples[k];
        const double part = static_cast<double>(k + 1) / static_cast<double>(samples.size());
        if (!is_own_way_free && part > free_part - 1e-9) return true;
        to[i] = pose;
        at[i] = body(i, pose);
        const std::vector<Pose> last = to;
        bool is_clear = false;
        for (int pass = 0; pass < 16 && !is_clear; ++pass) {
          is_clear = true;
          for (std::size_t b = 0; b <= pushed.size(); ++b) {
            const std::size_t by = b == 0 ? i : pushed[b - 1];
            for (const std::size_t o : by_id) {
              const auto known = static_cast<std::size_t>(std::ranges::find(pushed, o) - pushed.begin());
              if (!gives_way[o] || o == by || known < b || !overlap(at[by], at[o])) continue;
              stop.body = q.ids[b == 0 ? o : by] + 1;
              stop.behind = b == 0 ? 0 : q.ids[o] + 1;
              if (known == pushed.size()) {
                if (pushed.size() == question.limits[i]) {
                  too_many = true;
                  return false;
                }
                pushed.push_back(o);
                chained += b > 0;
                ++shifts;
              }
              const auto way = leave(q.bodies[by]->pieces, to[by], q.bodies[o]->pieces, to[o]);
              if (!way) return false;
              const double length = std::hypot(way->x(), way->y());
              to[o].x += way->x() * (1 + 1e-9 / length);
              to[o].y += way->y() * (1 + 1e-9 / length);
              at[o] = body(o, to[o]);
              is_clear = false;
            }
          }
        }
        if (!is_clear) return false;
        for (const std::size_t o : pushed) {
          if (to[o].x == last[o].x && to[o].y == last[o].y) continue;
          const bool is_far = std::sqrt(squared(to[o], last[o])) > 0.5 * q.bodies[o]->thinnest;
          stop.body = q.ids[o] + 1;
          stop.behind = 0;
          if (outside(to[o])) return false;
          stop.behind = in_way(o, last[o], body(o, last[o]), to[o], at[o],
                               [&](std::size_t other) { return other != i && !gives_way[other]; });
          if (is_far || stop.behind != 0) return false;
        }
      }
      return true;
    };
    const bool is_pushed = push();
    if (!is_pushed) answer.contacts[i] = stop;
    if (!is_own_way_free || !is_pushed) {
      turn_or_block();
      answer.stopped += is_own_way_free;
      answer.too_many += is_own_way_free && too_many;
      continue;
    }
    answer.outcomes[i] = moved;
    answer.shifts += shifts;
    answer.chained += chained;
    for (const std::size_t o : pushed) {
      answer.again += touched[o];
      touched[o] = true;
    }
    now = to;
    placed = at;
  }
  return answer;
}

}  // namespace troupe::oracle
