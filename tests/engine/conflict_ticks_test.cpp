#include "tests/engine/conflict_crowds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace troupe::oracle::conflict_ticks_test {
namespace {

using engine::Conflicts;
using Outcome = Conflicts::Outcome;

/// A crowd that moves tick after tick.
class Ticks {
 public:
  Ticks(TestCrowd& crowd, unsigned threads, double cell_m = 1)
      : crowd_(crowd), scene_(scene_of(crowd, cell_m)), parallel_(threads) {}

  /// Resolves the proposed motions and takes those that are allowed.
  const std::vector<Outcome>& step(const partition::GridGeometry& grid = {1, 3}) {
    outcomes_ = resolve(crowd_, scene_, grid, parallel_, conflicts_, free_);
    for (std::size_t i = 0; i < crowd_.size(); ++i)
      if (outcomes_[i] == Outcome::moved)
        crowd_.motions[i].from = crowd_.motions[i].to;
      else if (outcomes_[i] == Outcome::turned)
        crowd_.motions[i].from.heading = crowd_.motions[i].to.heading;
    ++crowd_.tick;
    return outcomes_;
  }
  /// Moves one body by (x, y) m, without a turn, if it is not blocked. Returns its outcome.
  Outcome drive(std::size_t body, double x, double y) {
    Motion& m = crowd_.motions[body];
    m.to = {m.from.x + x, m.from.y + y, 0, 0};
    m.moves = true;
    return step()[body];
  }
  std::vector<Blocks> placed() const {
    std::vector<Blocks> all;
    for (std::size_t i = 0; i < crowd_.size(); ++i)
      all.push_back(place(crowd_.bodies[i]->blocks, crowd_.motions[i].from));
    return all;
  }

 private:
  TestCrowd& crowd_;
  partition::StaticScene scene_;
  partition::Parallel parallel_;
  Conflicts conflicts_;
  std::vector<engine::FreeCircle> free_;
  std::vector<Outcome> outcomes_;
};

/// Pairs of bodies that overlap, by the oracle: entry a * size + b, a < b.
std::vector<bool> overlapping_pairs(const std::vector<Blocks>& placed) {
  std::vector<bool> pairs(placed.size() * placed.size());
  for (std::size_t a = 0; a < placed.size(); ++a)
    for (std::size_t b = a + 1; b < placed.size(); ++b)
      pairs[a * placed.size() + b] = overlap(placed[a], placed[b]);
  return pairs;
}

std::vector<Blocks> placed_walls(const TestCrowd& crowd) {
  std::vector<Blocks> walls;
  for (const Solid& wall : crowd.walls) walls.push_back(place({wall}, {}));
  return walls;
}

TEST(ConflictTicks, BodiesThatWereApartStayApart) {
  for (std::uint64_t seed = 1; seed <= (k_thrift > 1 ? 3 : 8); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Draw draw(3'000'000 + seed);
    TestCrowd crowd = random_crowd(draw, {.most_bodies = 120,
                                          .fill = 0.8,
                                          .small = seed % 2 ? 0.05 : 0.2,
                                          .large = seed % 2 ? 3 : 0.4,
                                          .walls = seed % 3 ? 10u : 0u,
                                          .region = true});
    const std::vector<Blocks> walls = placed_walls(crowd);
    Ticks run(crowd, 1 + static_cast<unsigned>(seed % 3));
    std::size_t moved = 0;
    std::size_t blocked = 0;
    if (seed % 2 == 0) crowd.draw_turns(draw);
    for (int tick = 0; tick < 300 / static_cast<int>(k_thrift); ++tick) {
      random_motions(crowd, draw, 60);
      const std::vector<Outcome>& outcomes = run.step();
      moved += static_cast<std::size_t>(std::ranges::count(outcomes, Outcome::moved));
      blocked += static_cast<std::size_t>(std::ranges::count(outcomes, Outcome::blocked));
      const std::vector<Blocks> placed = run.placed();
      const std::vector<bool> pairs = overlapping_pairs(placed);
      ASSERT_EQ(std::ranges::count(pairs, true), 0) << "tick " << tick;
      for (const Blocks& body : placed)
        for (const Blocks& wall : walls) ASSERT_FALSE(overlap(body, wall)) << "tick " << tick;
    }
    EXPECT_GT(moved, 1000 / k_thrift);
    EXPECT_GT(20 * blocked, moved) << "too easy";
  }
}

TEST(ConflictTicks, BodiesThatStartInOneAnotherOnlyPart) {
  std::size_t at_first = 0;
  std::size_t parted = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Draw draw(4'000'000 + seed);
    TestCrowd crowd =
        random_crowd(draw, {.most_bodies = 100, .fill = 0.6, .small = 0.2, .large = 1, .overlapping = 0.4});
    Ticks run(crowd, 2);
    std::vector<bool> before = overlapping_pairs(run.placed());
    const auto first = static_cast<std::size_t>(std::ranges::count(before, true));
    at_first += first;
    const auto depths = [&](std::size_t pair) {  // of each piece of one body in each piece of the other
      const std::size_t a = pair / crowd.size();
      const std::size_t b = pair % crowd.size();
      std::vector<double> all;
      for (const ConvexPrism& p : crowd.bodies[a]->pieces)
        for (const ConvexPrism& q : crowd.bodies[b]->pieces)
          all.push_back(p.z.shifted(crowd.motions[a].from.z).overlaps(q.z.shifted(crowd.motions[b].from.z))
                            ? depth(corners(p.outline, crowd.motions[a].from),
                                    corners(q.outline, crowd.motions[b].from))
                            : 0);
      return all;
    };
    for (int tick = 0; tick < 300 / static_cast<int>(k_thrift); ++tick) {
      random_motions(crowd, draw, 60);
      std::vector<std::vector<double>> depths_before(before.size());
      for (std::size_t p = 0; p < before.size(); ++p)
        if (before[p]) depths_before[p] = depths(p);
      run.step();
      std::vector<bool> after = overlapping_pairs(run.placed());
      for (std::size_t p = 0; p < after.size(); ++p) {
        if (!after[p]) continue;
        ASSERT_TRUE(before[p]) << "bodies " << p / crowd.size() << " and " << p % crowd.size()
                               << " met in tick " << tick;
        const std::vector<double> now = depths(p);
        for (std::size_t i = 0; i < now.size(); ++i)
          ASSERT_LE(now[i], std::max(depths_before[p][i] + 1e-9, 1e-9)) << "tick " << tick;
      }
      before = std::move(after);
    }
    parted += first - static_cast<std::size_t>(std::ranges::count(before, true));
  }
  EXPECT_GT(at_first, 100u);
  EXPECT_GT(parted, at_first / 2 / k_thrift) << "they should get free";
}

// Stage's floor plans often do not block; one that does holds no robot that starts in it, but any robot that
// has left it.
TEST(ConflictTicks, ASolidDoesNotHoldWhoIsInIt) {
  TestCrowd crowd;
  crowd.kinds.push_back(make_kind({{{rectangle(-0.1, -0.1, 0.1, 0.1)}, {0, 1}}}));
  crowd.walls.push_back({{rectangle(-1, -1, 1, 1)}, {0, 1}});
  crowd.walls.push_back({{rectangle(2, -1, 2.02, 1)}, {0, 1}});
  crowd.add(crowd.kinds[0], {0.005, 0, 0, 0});
  Ticks run(crowd, 1);
  Motion& m = crowd.motions[0];
  const auto drive = [&](double by) {
    m.to = m.from;
    m.to.x += by;
    m.moves = true;
    return run.step()[0];
  };
  for (int i = 0; i < 20; ++i) ASSERT_EQ(drive(0.06), Outcome::moved) << m.from.x;
  EXPECT_GT(m.from.x, 1.15) << "it is out";
  EXPECT_EQ(drive(-0.2), Outcome::blocked) << "and the way back is shut";
  while (m.from.x < 1.83) ASSERT_EQ(drive(0.06), Outcome::moved);
  EXPECT_EQ(drive(0.06), Outcome::blocked) << "the other wall never was open to it";
}

// The poses of bodies that are meant to touch a wall are rounded, so they may overlap it slightly.
TEST(ConflictTicks, AWallBlocksABodyThatOverlapsItByRounding) {
  const auto outcome = [](double overlap_m, const Pose& by) {
    TestCrowd crowd;
    crowd.kinds.push_back(make_kind({{{rectangle(-0.1, -0.1, 0.1, 0.1)}, {0, 1}}}));
    crowd.walls.push_back({{rectangle(1, -1, 3, 1)}, {0, 1}});
    crowd.add(crowd.kinds[0], {0.9 + overlap_m, 0, 0, 0});
    Motion& m = crowd.motions[0];
    m.to = {m.from.x + by.x, m.from.y + by.y, 0, by.heading};
    m.turn = by.heading;
    m.moves = true;
    return Ticks(crowd, 1).step()[0];
  };
  for (const double rounding_m : {0.0, 2e-16, 0.9e-9}) {
    EXPECT_EQ(outcome(rounding_m, {0.05, 0, 0, 0}), Outcome::blocked) << rounding_m;
    EXPECT_EQ(outcome(rounding_m, {0, 0, 0, 0.1}), Outcome::blocked)
        << rounding_m << ": its corners turn into it";
    EXPECT_EQ(outcome(rounding_m, {0, 0.05, 0, 0}), Outcome::moved) << rounding_m << ": along the wall";
    EXPECT_EQ(outcome(rounding_m, {-0.05, 0, 0, 0}), Outcome::moved) << rounding_m;
  }
  for (const double overlap_m : {1e-8, 0.01}) {
    EXPECT_EQ(outcome(overlap_m, {0.05, 0, 0, 0}), Outcome::blocked) << overlap_m;
    EXPECT_EQ(outcome(overlap_m, {0, 0, 0, 0.1}), Outcome::blocked) << overlap_m;
    EXPECT_EQ(outcome(overlap_m, {0, 0.05, 0, 0}), Outcome::moved) << overlap_m;
    EXPECT_EQ(outcome(overlap_m, {-0.05, 0, 0, 0}), Outcome::moved) << overlap_m;
  }
}

// The pieces of a solid count one by one: who overlaps one arm of an L may not drive into the other.
TEST(ConflictTicks, ASolidThatABodyOverlapsBlocksItElsewhere) {
  TestCrowd crowd;
  crowd.kinds.push_back(make_kind({{{rectangle(-0.1, -0.1, 0.1, 0.1)}, {0, 1}}}));
  const Ring l{{0, 0}, {2, 0}, {2, 0.2}, {0.2, 0.2}, {0.2, 2}, {0, 2}};
  crowd.walls.push_back({{l}, {0, 1}});
  crowd.add(crowd.kinds[0], {0.29, 0.5, 0, 0});  // 1 cm in the upright arm
  Ticks run(crowd, 1);
  const Pose& at = crowd.motions[0].from;
  EXPECT_EQ(run.drive(0, -0.02, 0), Outcome::blocked);
  while (at.y > 0.32) ASSERT_EQ(run.drive(0, 0, -0.02), Outcome::moved) << at.y;
  EXPECT_EQ(run.drive(0, 0, -0.05), Outcome::blocked) << "the other arm";
  EXPECT_EQ(run.drive(0, 0.05, 0), Outcome::moved);
  EXPECT_EQ(run.drive(0, -0.05, 0), Outcome::blocked) << "it is out";
}

// The depth counts, not the distance of the origins, which a long body has far from its ends.
TEST(ConflictTicks, AMotionPastTheEndOfALongBodyGoesNoDeeper) {
  TestCrowd crowd;
  crowd.kinds.push_back(make_kind({{{rectangle(-2, -0.2, 2, 0.2)}, {0, 1}}}));
  crowd.kinds.push_back(make_kind({{{rectangle(-0.1, -0.1, 0.1, 0.1)}, {0, 1}}}));
  crowd.add(crowd.kinds[0], {0, 0, 0, 0});
  crowd.add(crowd.kinds[1], {1.5, 0.29, 0, 0});  // 1 cm in the truck, near its end
  Ticks run(crowd, 1);
  EXPECT_EQ(run.drive(1, 0.1, -0.02), Outcome::blocked) << "farther from its origin, but deeper";
  EXPECT_EQ(run.drive(1, -0.1, 0), Outcome::moved) << "nearer to its origin, but no deeper";
  EXPECT_EQ(run.drive(1, 0, 0.05), Outcome::moved);
  EXPECT_EQ(run.drive(1, 0, -0.05), Outcome::blocked) << "it is out";
}

// A body that is wholly inside a solid crosses none of its edges.
TEST(ConflictTicks, ABodyInsideASolidGoesNoDeeper) {
  TestCrowd crowd;
  crowd.kinds.push_back(make_kind({{{rectangle(-0.1, -0.1, 0.1, 0.1)}, {0, 1}}}));
  crowd.walls.push_back({{rectangle(-1, -1, 1, 1)}, {0, 1}});
  crowd.add(crowd.kinds[0], {0.5, 0, 0, 0});
  Ticks run(crowd, 1);
  EXPECT_EQ(run.drive(0, -0.05, 0), Outcome::blocked);
  EXPECT_EQ(run.drive(0, 0.05, 0), Outcome::moved);
}

/// A room of 0.02 m walls about the origin: four blocks, or one region with a hole as bitmaps make them.
std::vector<Solid> room(double half, bool region) {
  const double out = half + 0.02;
  if (region) return {{{rectangle(-out, -out, out, out), rectangle(-half, -half, half, half)}, {0, 1}}};
  return {{{rectangle(-out, half, out, out)}, {0, 1}},
          {{rectangle(-out, -out, out, -half)}, {0, 1}},
          {{rectangle(half, -half, out, half)}, {0, 1}},
          {{rectangle(-out, -half, -half, half)}, {0, 1}}};
}

class NoTunnel : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Wall, NoTunnel, ::testing::Values(false, true),
                         [](const auto& region) { return region.param ? "region" : "block"; });

TEST_P(NoTunnel, NoBodyLeavesARoomOfThinWalls) {
  std::size_t blocked = 0;
  std::size_t moved = 0;
  for (std::uint64_t seed = 1; seed <= 60 / k_thrift; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Draw draw(5'000'000 + seed);
    TestCrowd crowd;
    crowd.walls = room(2, GetParam());
    if (draw.chance(0.4)) {  // a needle of 5 mm
      const double h = draw.real(0.1, 0.5);
      crowd.kinds.push_back(make_kind({{{rectangle(-h, -0.0025, h, 0.0025)}, {0, 0.5}}}));
    } else {
      do crowd.kinds.assign(1, random_kind(draw, draw.scale(0.05, 1.5)));
      while (crowd.kinds[0].shape.z.min >= 0.5);
    }
    const Kind& kind = crowd.kinds[0];
    crowd.add(kind, {draw.real(-0.5, 0.5), draw.real(-0.5, 0.5), 0, draw.real(-3, 3)});
    Ticks run(crowd, 1, draw.scale(0.1, 3));
    const Vec2 middle = kind.shape.pieces[0].outline[0];
    for (int tick = 0; tick < 120; ++tick) {
      Motion& m = crowd.motions[0];
      const double direction = draw.real(-k_pi, k_pi);
      const double turn = draw.chance(0.5) ? 0 : draw.real(-2, 2);
      m.to = compose(m.from, {std::cos(direction), std::sin(direction), 0, turn});  // 10 m/s for 0.1 s
      m.turn = turn;
      m.moves = true;
      // Refused all the time it would stay in the middle: now and then go up to a wall in smaller steps.
      if (tick % 2)
        m.to = {m.from.x + 0.1 * (m.to.x - m.from.x), m.from.y + 0.1 * (m.to.y - m.from.y), 0, m.to.heading};
      const Outcome outcome = run.step()[0];
      blocked += outcome == Outcome::blocked;
      moved += outcome == Outcome::moved;
      for (const ConvexPrism& piece : kind.shape.pieces) {
        for (const Vec2& v : piece.outline) {
          const Vec2 corner = Transform(m.from) * v;
          ASSERT_LT(corner.cwiseAbs().maxCoeff(), 2 + 1e-12) << "tick " << tick;
        }
      }
      ASSERT_LT((Transform(m.from) * middle).cwiseAbs().maxCoeff(), 2);
    }
  }
  EXPECT_GT(blocked, 1000 / k_thrift);
  EXPECT_GT(moved, 1000 / k_thrift);
}

TEST_P(NoTunnel, NoBodyCrossesAWallAtAnyAngle) {
  std::size_t crossings = 0;
  for (std::uint64_t seed = 1; seed <= 4000 / k_thrift; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Draw draw(6'000'000 + seed);
    TestCrowd crowd;
    // A wall along y, turned: as a block, or as a region with a window too high up to matter.
    const double angle = draw.real(-k_pi, k_pi);
    Solid wall{{turned(rectangle(0, -20, 0.02, 20), angle)}, {0, 1}};
    if (GetParam()) wall.contours.push_back(turned(rectangle(0.005, 18, 0.015, 19), angle));
    crowd.walls.push_back(wall);
    const double size = draw.scale(0.05, 1);
    crowd.kinds.push_back(draw.chance(0.2)
                              ? make_kind({{{rectangle(-size, -0.0025, size, 0.0025)}, {0, 0.5}}})
                              : random_kind(draw, size));
    const Kind& kind = crowd.kinds[0];
    if (kind.shape.z.min > 0) continue;
    // From one side, where it is clear of the wall, far enough to be clear of it on the other.
    const double reach = kind.shape.radius + 0.001;
    const double start = -reach - draw.real(0, 0.2);
    const double path = draw.real(0.03, 1) + 2 * reach + 0.22;
    const double slope = draw.real(-1.2, 1.2);
    const Rotation rotation(angle);
    const Vec2 from = rotation * Vec2(start, draw.real(-5, 5));
    const Vec2 to = from + rotation * Vec2(path, path * slope);
    crowd.add(kind, {from.x(), from.y(), 0, draw.real(-3, 3)});
    Motion& m = crowd.motions[0];
    m.turn = draw.chance(0.3) ? 0 : draw.real(-6, 6);
    m.to = {to.x(), to.y(), 0, m.from.heading + m.turn};
    m.moves = true;
    Ticks run(crowd, 1, draw.scale(0.1, 3));
    ASSERT_EQ(run.step()[0], Outcome::blocked);
    ++crossings;
  }
  EXPECT_GT(crossings, 2500 / k_thrift);
}

// In a passage as wide as they are, two bodies can only push towards each other: they never change places.
TEST(ConflictTicks, FastBodiesDoNotPassThroughEachOther) {
  for (std::uint64_t seed = 1; seed <= (test::k_slow_build ? 6 : 40); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Draw draw(7'000'000 + seed);
    TestCrowd crowd;
    const double length = draw.chance(0.5) ? 0.005 : 0.05;
    crowd.kinds.push_back(make_kind({{{rectangle(-length, -0.24, length, 0.24)}, {0, 1}}}));
    crowd.kinds.push_back(make_kind({{{rectangle(-0.1, -0.24, 0.1, 0.24)}, {0, 1}}}));
    crowd.walls.push_back({{rectangle(-5, 0.25, 5, 0.3)}, {0, 1}});
    crowd.walls.push_back({{rectangle(-5, -0.3, 5, -0.25)}, {0, 1}});
    crowd.bounds = Box::around({0, 0}, 4);
    for (int i = 0; i < 4; ++i)
      crowd.add(crowd.kinds[static_cast<std::size_t>(i % 2)], {0.5 * i - 1, 0, 0, 0});
    Ticks run(crowd, 2);
    std::size_t moved = 0;
    for (int tick = 0; tick < 200; ++tick) {
      for (Motion& m : crowd.motions) {
        m.to = m.from;
        m.to.x += draw.real(-1, 1) * (draw.chance(0.5) ? 1 : 0.2);
        m.moves = true;
      }
      moved += static_cast<std::size_t>(std::ranges::count(run.step(), Outcome::moved));
      for (std::size_t i = 0; i + 1 < crowd.size(); ++i)
        ASSERT_LT(crowd.motions[i].from.x + length + 0.1, crowd.motions[i + 1].from.x + 1e-12)
            << "tick " << tick;
    }
    EXPECT_GT(moved, 50u);
  }
}

/// A rank without ghosts, whose connection to the other ranks fails at the end of the resolution.
class FailingBorder final : public Conflicts::Border {
 public:
  std::span<const std::uint32_t> begin(std::span<const engine::Motion>,
                                       std::span<const std::uint32_t> order) override {
    return order;
  }
  bool exchange(Conflicts&) override { return false; }
  void exchange_places(Conflicts&) override { throw std::runtime_error("failed"); }
};

// An exception ends a resolution whose outcomes are already stored: the next one must not take them for its
// own.
TEST(ConflictTicks, AResolutionThatThrowsIsForgotten) {
  TestCrowd crowd;  // a column of bodies, each of which moves into the place of the next
  crowd.kinds.push_back(make_kind({{{rectangle(-0.1, -0.1, 0.1, 0.1)}, {0, 1}}}));
  for (int i = 0; i < 40; ++i) crowd.add(crowd.kinds.front(), {0.22 * i, 0, 0, 0});
  const std::vector<Motion> at_rest = crowd.motions;
  for (Motion& m : crowd.motions) {
    m.to.x += 0.2;
    m.moves = true;
  }
  const partition::StaticScene scene = scene_of(crowd, 1);
  const partition::GridGeometry grid{1, 3};
  partition::Parallel parallel(1);
  Conflicts conflicts;
  std::vector<engine::FreeCircle> free;
  const auto outcomes = [&](Conflicts::Border* border = nullptr) {
    return resolve(crowd, scene, grid, parallel, conflicts, free, {}, border);
  };
  FailingBorder border;
  EXPECT_THROW(outcomes(&border), std::runtime_error);
  const std::vector<Motion> moving = std::exchange(crowd.motions, at_rest);
  for (const Outcome outcome : outcomes()) EXPECT_EQ(outcome, Outcome::stands);

  crowd.motions = moving;
  EXPECT_THROW(outcomes(&border), std::runtime_error);
  ++crowd.tick;
  const std::vector<Outcome> next = outcomes();
  EXPECT_GT(conflicts.rounds(), 1u);
  Conflicts others;
  EXPECT_EQ(next, resolve(crowd, scene, grid, parallel, others));
}

TEST(ConflictTicks, BodiesAreHeldAtTheBounds) {
  TestCrowd crowd;
  crowd.kinds.push_back(make_kind({{{rectangle(-0.25, -0.25, 0.25, 0.25)}, {0, 1}}}));
  crowd.kinds.push_back(make_kind({}));  // blocks no body
  crowd.bounds = Box::around({0, 0}, 1);
  crowd.add(crowd.kinds[0], {0.75, 0, 0, 0});
  crowd.add(crowd.kinds[1], {0.75, 0, 0, 0});
  Ticks run(crowd, 1);
  const auto drive = [&](double by) {
    for (Motion& m : crowd.motions) {
      m.to = m.from;
      m.to.x += by;
      m.moves = true;
    }
    return run.step();
  };
  const std::vector<Outcome> free(2, Outcome::moved);
  const std::vector<Outcome> out_of_bounds(2, Outcome::out_of_bounds);
  EXPECT_EQ(drive(0.25), free) << "up to the bounds";
  EXPECT_EQ(drive(0.25), out_of_bounds);
  EXPECT_EQ(drive(-0.25), free);
  for (Motion& m : crowd.motions) m.moves = false;
  EXPECT_EQ(run.step(), std::vector<Outcome>(2, Outcome::stands));
}

}  // namespace
}  // namespace troupe::oracle::conflict_ticks_test
