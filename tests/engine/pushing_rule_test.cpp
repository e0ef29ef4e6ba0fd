// Compares pushing with a direct implementation of its rule, which resolves one body after the other.
#include "tests/engine/conflict_crowds.hpp"
#include "tests/engine/push_oracle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

namespace troupe::oracle::pushing_rule_test {
namespace {

using engine::Conflicts;
using Outcome = Conflicts::Outcome;

constexpr std::array<unsigned, 4> k_threads{1, 2, 3, 8};
constexpr std::array<partition::GridGeometry, 4> k_grids{{{0.25, 4}, {1, 3}, {7, 0}, {0.6, 6}}};

struct PushCrowd : TestCrowd {
  std::vector<std::uint8_t> pushable;
  std::vector<std::uint8_t> limits;

  PushQuestion ask() const {
    return {question(), {pushable.begin(), pushable.end()}, {limits.begin(), limits.end()}};
  }
  engine::Pushables pushables() const {
    engine::Pushables out{pushable, limits, 0, 1e300, 0};
    for (std::size_t i = 0; i < size(); ++i) {
      out.most += limits[i];
      if (pushable[i] == 0) continue;
      out.radius = std::max(out.radius, shapes[i]->radius);
      out.thinnest = std::min(out.thinnest, shapes[i]->thinnest);
    }
    return out;
  }
};

struct Resolved {
  std::vector<Outcome> outcomes;
  std::vector<Pose> poses;
  std::vector<Conflicts::Block> blocks;
  std::uint64_t rounds = 0;
};

Resolved resolve_engine(const PushCrowd& crowd, const partition::StaticScene& scene,
                        const partition::GridGeometry& grid, partition::Parallel& parallel,
                        Conflicts& conflicts) {
  std::vector<engine::FreeCircle> free;
  Resolved resolved;
  resolved.outcomes =
      resolve(crowd, scene, grid, parallel, conflicts, free, crowd.pushables(), nullptr, &resolved.blocks);
  resolved.rounds = conflicts.rounds();
  for (std::size_t i = 0; i < crowd.size(); ++i) {
    const Motion& motion = crowd.motions[i];
    resolved.poses.push_back(resolved.outcomes[i] == Outcome::moved ? motion.to : motion.from);
    if (resolved.outcomes[i] == Outcome::turned) resolved.poses.back().heading = motion.to.heading;
  }
  for (const Conflicts::Push& push : conflicts.pushes()) {
    if (!conflicts.is_last(push)) continue;
    resolved.poses[push.row].x = push.position.x();
    resolved.poses[push.row].y = push.position.y();
  }
  return resolved;
}

/// Robots and pucks, dropped where they find room.
PushCrowd random_pushers(Draw& draw, std::size_t most, double fill, bool walls) {
  PushCrowd crowd;
  crowd.seed = draw.below(1000);
  crowd.tick = draw.below(1000);
  std::vector<bool> is_puck;
  std::vector<std::size_t> limit;
  double area = 0;
  const std::size_t kinds = 3 + draw.below(4);
  for (std::size_t k = 0; k < kinds; ++k) {
    is_puck.push_back(k == 0 || (k > 1 && draw.chance(0.6)));
    const double size = is_puck[k] ? draw.scale(0.06, 0.3) : draw.scale(0.2, 0.8);
    crowd.kinds.push_back(is_puck[k] && draw.chance(0.7)
                              ? make_kind({{{random_star(draw, 5 + draw.below(8), size / 2, 1)}, {0, 0.3}}})
                              : random_kind(draw, size));
    limit.push_back(is_puck[k] ? 0 : draw.chance(0.2) ? 0 : 1 + draw.below(6));
    area += size * size / static_cast<double>(kinds);
  }
  const double side = std::sqrt(area * static_cast<double>(most) / fill);
  const Vec2 corner(draw.real(-50, 50), draw.real(-50, 50));
  if (walls) {
    for (std::size_t w = 0; w < 6; ++w)
      crowd.walls.push_back({{turned(rectangle(0, 0, draw.scale(0.2, 3), 0.02), draw.real(0, 6),
                                     corner + Vec2(draw.real(0, side), draw.real(0, side)))},
                             {0, 1}});
    const double x = corner.x();
    const double y = corner.y();
    crowd.walls.push_back({{rectangle(x - 0.3, y - 0.3, x + side + 0.3, y + side + 0.3),
                            rectangle(x - 0.25, y - 0.25, x + side + 0.25, y + side + 0.25)},
                           {0, 1}});
  }
  if (draw.chance(0.2)) crowd.bounds = Box::around(corner + Vec2(side / 2, side / 2), 0.48 * side);
  std::vector<Blocks> solid;
  for (const Solid& wall : crowd.walls) solid.push_back(place({wall}, {}));
  const bool may_overlap = draw.chance(0.2);
  for (std::size_t i = 0; i < most; ++i) {
    const std::size_t k = draw.below(kinds);
    const bool anyhow = may_overlap && draw.chance(0.1);
    for (int trial = 0; trial < 60; ++trial) {
      const Pose pose{corner.x() + draw.real(0, side), corner.y() + draw.real(0, side), 0, draw.real(-3, 3)};
      Blocks placed = place(crowd.kinds[k].body.blocks, pose);
      if (!anyhow && std::ranges::any_of(solid, [&](const Blocks& other) { return overlap(placed, other); }))
        continue;
      solid.push_back(std::move(placed));
      crowd.add(crowd.kinds[k], pose);
      crowd.pushable.push_back(is_puck[k]);
      crowd.limits.push_back(static_cast<std::uint8_t>(limit[k]));
      break;
    }
  }
  return crowd;
}

/// Robots go as they please; pucks do not move by themselves. most_poses: not a whole number, or it is a
/// matter of rounding at how many poses a motion is looked at.
void propose(PushCrowd& crowd, Draw& draw, double most_poses) {
  random_motions(crowd, draw, most_poses);
  const bool gently = draw.chance(0.7);
  for (std::size_t i = 0; i < crowd.size(); ++i) {
    Motion& m = crowd.motions[i];
    if (gently) {
      const double way = crowd.shapes[i]->radius * draw.real(0.05, 0.7);
      m = {m.from, m.from, draw.chance(0.5) ? 0 : draw.real(-0.2, 0.2), true};
      const double direction = draw.real(-k_pi, k_pi);
      m.to = compose(m.from, {way * std::cos(direction), way * std::sin(direction), 0, m.turn});
    }
    if (crowd.pushable[i] != 0) m = {m.from, m.from, 0, false};
  }
}

struct Tally {
  std::size_t crowds = 0, moving = 0, blocked = 0, shifts = 0, chained = 0, again = 0, stopped = 0,
              too_many = 0, order_matters = 0, deep = 0, held = 0, behind = 0;
  void report() const {
    std::printf(
        "%zu crowds, %zu motions, %zu blocked; %zu pushed, %zu of them by others, %zu again; %zu stopped, "
        "%zu by "
        "too many; the order matters in %zu; a body waited for one that waited in %zu\n",
        crowds, moving, blocked, shifts, chained, again, stopped, too_many, order_matters, deep);
  }
};

class PushingRule : public ::testing::Test {
 protected:
  PushingRule() {
    for (const unsigned threads : k_threads) parallel_.emplace_back(threads);
  }
  /// Body for body as the oracle says: outcomes, and places to a nanometre; bit for bit on any threads and
  /// tiles.
  void compare(PushCrowd& crowd, Tally& tally) {
    const PushAnswer expected = resolve_pushing(crowd.ask());
    Resolved first;
    for (std::size_t t = 0; t < k_threads.size(); ++t) {
      const partition::GridGeometry& grid = k_grids[(tally.crowds + t) % k_grids.size()];
      Resolved got = resolve_engine(crowd, scene_of(crowd, 1.1), grid, parallel_[t], conflicts_[t]);
      for (std::size_t i = 0; i < crowd.size(); ++i) {
        ASSERT_EQ(static_cast<int>(got.outcomes[i]), static_cast<int>(expected.outcomes[i]))
            << "body " << i << " of " << crowd.size() << ", " << k_threads[t] << " threads, cells of "
            << grid.cell_m;
        ASSERT_NEAR(got.poses[i].x, expected.poses[i].x, 1e-9) << "body " << i;
        ASSERT_NEAR(got.poses[i].y, expected.poses[i].y, 1e-9) << "body " << i;
        ASSERT_EQ(got.poses[i].heading, expected.poses[i].heading) << "body " << i;
        ASSERT_TRUE(t == 0 || got.poses[i] == first.poses[i]) << k_threads[t] << " threads";
        const engine::Contact& contact = got.blocks[i].contact;
        const engine::Contact& wanted = expected.contacts[i];
        ASSERT_TRUE(contact == wanted)
            << "body " << i << ": " << contact.cause << " " << contact.body << " " << contact.behind
            << ", expected " << wanted.cause << " " << wanted.body << " " << wanted.behind;
      }
      ASSERT_TRUE(t == 0 || got.rounds == first.rounds) << k_threads[t] << " threads";
      if (t == 0) first = std::move(got);
    }
    ++tally.crowds;
    for (const Motion& m : crowd.motions) tally.moving += m.moves;
    tally.blocked += static_cast<std::size_t>(std::ranges::count(expected.outcomes, Outcome::blocked));
    tally.shifts += expected.shifts;
    tally.chained += expected.chained;
    tally.again += expected.again;
    tally.stopped += expected.stopped;
    tally.too_many += expected.too_many;
    for (const engine::Contact& contact : expected.contacts) {
      tally.held += contact.cause == engine::Contact::k_pushed;
      tally.behind += contact.behind != 0;
    }
    tally.deep += first.rounds > 2;
    const PushAnswer other = resolve_pushing(crowd.ask(), false);
    tally.order_matters += other.outcomes != expected.outcomes || other.poses != expected.poses;
    poses_ = std::move(first.poses);
  }
  std::vector<Pose> poses_;

 private:
  std::vector<partition::Parallel> parallel_;
  std::array<Conflicts, k_threads.size()> conflicts_;
};

TEST_F(PushingRule, RandomCrowdsAreResolvedAsTheRuleSays) {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 900 / k_thrift; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Draw draw(8'000'000 + seed);
    PushCrowd crowd = random_pushers(draw, 10 + draw.below(60), draw.real(0.5, 2), draw.chance(0.5));
    propose(crowd, draw, 40.5);
    if (seed % 3 == 0) crowd.draw_turns(draw);
    compare(crowd, tally);
    if (HasFatalFailure()) return;
  }
  tally.report();
  EXPECT_GT(tally.shifts, tally.crowds);
  if (k_thrift > 1) return;  // too few crowds for what is rare in them
  EXPECT_GT(6 * tally.order_matters, tally.crowds);
  EXPECT_GT(tally.chained, tally.crowds / 10);
  EXPECT_GT(tally.again, tally.crowds / 300);
  EXPECT_GT(tally.too_many, tally.crowds / 50);
  EXPECT_GT(tally.held, tally.crowds / 10);
  EXPECT_GT(tally.behind, tally.crowds / 20);
}

TEST_F(PushingRule, LargeCrowdsAreResolvedAsTheRuleSays) {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 20 / k_thrift; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Draw draw(8'100'000 + seed);
    PushCrowd crowd = random_pushers(draw, 300 + draw.below(300), draw.real(0.5, 2), draw.chance(0.5));
    propose(crowd, draw, 20.5);
    if (seed % 3 == 0) crowd.draw_turns(draw);
    compare(crowd, tally);
    if (HasFatalFailure()) return;
  }
  tally.report();
  EXPECT_GT(2 * tally.order_matters, tally.crowds);
  EXPECT_GT(tally.deep, 0u);
}

// Robots that drive many times their length in a tick hand a puck on to one another. So it may come from far
// away to a robot that had no puck near it, and then blocks this robot.
TEST_F(PushingRule, APuckFromFarAwayBlocks) {
  Tally tally;
  std::size_t from_afar = 0;
  for (std::uint64_t seed = 1; seed <= 600 / k_thrift; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Draw draw(8'300'000 + seed);
    PushCrowd crowd;
    crowd.seed = seed;
    crowd.kinds.push_back(make_kind({{{rectangle(-0.05, -0.02, 0.05, 0.02)}, {0, 0.2}}}));
    crowd.kinds.push_back(make_kind({{{random_star(draw, 9, 0.06, 1)}, {0, 0.2}}}));
    const auto add = [&](std::size_t kind, const Pose& from, double length) {
      crowd.add(crowd.kinds[kind], from);
      crowd.pushable.push_back(kind == 1);
      crowd.limits.push_back(kind == 1 ? 0 : 1);
      crowd.motions.back() = {from, compose(from, {length, 0, 0, 0}), 0, length > 0};
    };
    Vec2 puck(0, 0);
    add(1, {0, 0, 0, 0}, 0);
    for (int i = 0; i < 4; ++i) {
      const double heading = draw.real(-k_pi, k_pi);
      // Only the first and the third robot drive far. The others are too far from the puck to push it.
      const double length = i % 2 == 0 ? draw.real(1.5, 3) : draw.real(0.3, 0.6);
      const Vec2 ahead(std::cos(heading), std::sin(heading));
      const Vec2 from = puck - ahead * (i == 0 ? 0.2 : 0.2 + length * draw.real(0, 0.8));
      add(0, {from.x(), from.y(), 0, heading}, length);
      puck = from + ahead * (length + 0.1);
    }
    const PushQuestion before = crowd.ask();
    std::vector<bool> overlapped(crowd.size());
    for (std::size_t i = 1; i < crowd.size(); ++i)
      overlapped[i] = overlap(place(crowd.bodies[0]->blocks, before.base.motions[0].from),
                              place(crowd.bodies[i]->blocks, before.base.motions[i].from));
    compare(crowd, tally);
    if (HasFatalFailure()) return;
    from_afar += resolve_pushing(before, true, false).outcomes != resolve_pushing(before).outcomes;
    for (std::size_t i = 1; i < crowd.size(); ++i)
      ASSERT_TRUE(overlapped[i] || !overlap(place(crowd.bodies[0]->blocks, poses_[0]),
                                            place(crowd.bodies[i]->blocks, poses_[i])))
          << "robot " << i;
  }
  tally.report();
  EXPECT_GT(from_afar, 0u) << "pucks that came from far away";
}

// Over many ticks: nothing that was apart ever overlaps, and nothing goes through a wall.
TEST_F(PushingRule, NothingOverlapsAndNothingLeavesARoom) {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 8 / (k_thrift > 1 ? 4 : 1); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Draw draw(8'200'000 + seed);
    PushCrowd crowd;
    crowd.seed = seed;
    crowd.kinds.push_back(make_kind({{{rectangle(-0.15, -0.12, 0.15, 0.12)}, {0, 0.2}}}));
    crowd.kinds.push_back(make_kind({{{random_star(draw, 9, 0.06, 1)}, {0, 0.1}}}));
    crowd.walls.push_back({{rectangle(-1.02, -1.02, 1.02, 1.02), rectangle(-1, -1, 1, 1)}, {0, 1}});
    std::vector<Blocks> solid;
    for (std::size_t i = 0; i < 70; ++i) {
      const std::size_t k = i < 8 ? 0 : 1;
      for (int trial = 0; trial < 100; ++trial) {
        const Pose pose{draw.real(-0.8, 0.8), draw.real(-0.8, 0.8), 0, draw.real(-3, 3)};
        Blocks placed = place(crowd.kinds[k].body.blocks, pose);
        if (std::ranges::any_of(solid, [&](const Blocks& other) { return overlap(placed, other); })) continue;
        solid.push_back(std::move(placed));
        crowd.add(crowd.kinds[k], pose);
        crowd.pushable.push_back(k == 1);
        crowd.limits.push_back(k == 1 ? 0 : 4);
        break;
      }
    }
    std::vector<double> headings(crowd.size());
    for (int tick = 0; tick < 150 / static_cast<int>(k_thrift); ++tick, ++crowd.tick) {
      for (std::size_t i = 0; i < crowd.size(); ++i) {
        Motion& m = crowd.motions[i];
        m = {m.from, m.from, 0, crowd.pushable[i] == 0};
        if (!m.moves) continue;
        m.turn = draw.chance(0.1) ? draw.real(-1, 1) : draw.real(-0.1, 0.1);
        m.to = compose(m.from, {draw.chance(0.05) ? draw.real(-0.2, 0.2) : 0.03, 0, 0, m.turn});
      }
      compare(crowd, tally);
      if (HasFatalFailure()) return;
      std::vector<Blocks> placed;
      for (std::size_t i = 0; i < crowd.size(); ++i) {
        crowd.motions[i].from = poses_[i];
        placed.push_back(place(crowd.bodies[i]->blocks, poses_[i]));
        for (const ConvexPrism& piece : crowd.shapes[i]->pieces)
          for (const Vec2& v : piece.outline)
            ASSERT_LT((Transform(poses_[i]) * v).cwiseAbs().maxCoeff(), 1 + 1e-12) << "tick " << tick;
      }
      for (std::size_t a = 0; a < placed.size(); ++a)
        for (std::size_t b = a + 1; b < placed.size(); ++b)
          ASSERT_FALSE(overlap(placed[a], placed[b])) << a << " and " << b << ", tick " << tick;
    }
  }
  tally.report();
  EXPECT_GT(tally.shifts, 1000 / k_thrift);
}

}  // namespace
}  // namespace troupe::oracle::pushing_rule_test
