#include "engine/placement.hpp"

#include "base/math.hpp"
#include "base/random.hpp"
#include "tests/support/slow_build.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <cmath>

namespace troupe::engine {
namespace {

using testing::ElementsAre;

using Size = Eigen::Vector2d;

partition::Parallel& one_thread() {
  static partition::Parallel parallel(1);
  return parallel;
}

Solid box(const Vec2& center, const Size& size, ZInterval z = {0, 1}) {
  const Vec2 h = 0.5 * size;
  return {{{center - h, center + Vec2(h.x(), -h.y()), center + h, center + Vec2(-h.x(), h.y())}}, z};
}

partition::ObstacleShape box_shape(const Size& size, ZInterval z = {0, 1}) {
  TypeSpec type;
  type.parts.push_back({.solids = {box({0, 0}, size, z)}});
  return obstacle_shape(type);
}

Box region(double x0, double y0, double x1, double y1) {
  Box b;
  b.extend(Vec2(x0, y0));
  b.extend(Vec2(x1, y1));
  return b;
}

/// Depth to which two rectangles share area: the smallest overlap over their four axes, below 0 when apart.
/// The tests' own, with the standard library's sine, so that it shares nothing with what it checks.
double depth(const Size& a, const Pose& pose_a, const Size& b, const Pose& pose_b) {
  const auto corners = [](const Size& size, const Pose& pose) {
    std::array<Vec2, 4> c;
    for (int i = 0; i < 4; ++i) {
      const double x = (i & 1 ? 0.5 : -0.5) * size.x(), y = (i & 2 ? 0.5 : -0.5) * size.y();
      c[i] = {pose.x + x * std::cos(pose.heading) - y * std::sin(pose.heading),
              pose.y + x * std::sin(pose.heading) + y * std::cos(pose.heading)};
    }
    return c;
  };
  const auto ca = corners(a, pose_a), cb = corners(b, pose_b);
  double least = 1e300;
  for (const double heading :
       {pose_a.heading, pose_a.heading + k_pi / 2, pose_b.heading, pose_b.heading + k_pi / 2}) {
    const Vec2 axis(std::cos(heading), std::sin(heading));
    double a0 = 1e300, a1 = -1e300, b0 = 1e300, b1 = -1e300;
    for (int i = 0; i < 4; ++i) {
      a0 = std::min(a0, axis.dot(ca[i]));
      a1 = std::max(a1, axis.dot(ca[i]));
      b0 = std::min(b0, axis.dot(cb[i]));
      b1 = std::max(b1, axis.dot(cb[i]));
    }
    least = std::min(least, std::min(a1, b1) - std::max(a0, b0));
  }
  return least;
}

constexpr double k_touch = 1e-9;  // m: nearer than this, rounding decides

/// A scene, a rule and a body, all at random.
struct Setting {
  std::vector<std::pair<Size, Pose>> walls;
  Size size;
  PlacementRule rule;
  std::uint64_t seed;

  partition::StaticScene scene(double cell_m) const {
    std::vector<partition::FixedSolid> solids;
    for (std::size_t i = 0; i < walls.size(); ++i) {
      const Transform transform(walls[i].second);
      Solid solid = box({0, 0}, walls[i].first);
      for (Vec2& p : solid.contours[0]) p = transform * p;
      solids.push_back({solid, BodyId(i + 1)});
    }
    return {std::move(solids), cell_m};
  }
  std::vector<Pose> placed(std::size_t count, double cell_m = 0.5) const {
    Crowd crowd;
    return place(rule, box_shape(size), count, seed, "p", std::nullopt, scene(cell_m), crowd, one_thread());
  }
};

double any(double low, double high) { return low + (high - low) * (*rc::gen::inRange(0, 1000001) / 1e6); }

Setting any_setting() {
  Setting s;
  for (int i = *rc::gen::inRange(0, 8); i > 0; --i)
    s.walls.push_back({{any(0.02, 3), any(0.02, 3)}, {any(-5, 5), any(-5, 5), 0, any(-4, 4)}});
  s.size = {any(0.05, 0.8), any(0.05, 0.8)};
  s.rule.kind = *rc::gen::element(PlacementRule::Kind::grid, PlacementRule::Kind::uniform);
  s.rule.region = region(any(-5, -1), any(-5, -1), any(0, 4), any(0, 4));
  s.rule.pitch_m = any(0.2, 1.2);
  s.rule.jitter_m = *rc::gen::element(0.0, 0.1, 0.7);
  if (*rc::gen::arbitrary<bool>()) s.rule.heading = any(-3, 3);
  s.rule.trials = 50;
  s.seed = *rc::gen::arbitrary<std::uint64_t>();
  return s;
}

TEST(Placement, GridFillsColumnByColumn) {
  const PlacementRule rule{.region = region(1, 2, 1.3, 2.2), .pitch_m = 0.1, .heading = 0.5, .z = 3};
  EXPECT_EQ(grid_cells(rule), 4 * 3);
  Crowd crowd;
  const auto poses = place(rule, box_shape({0.01, 0.01}), 5, 1, "p", std::nullopt, {}, crowd, one_thread());
  EXPECT_THAT(poses, ElementsAre(Pose{1, 2, 3, 0.5}, Pose{1, 2.1, 3, 0.5}, Pose{1, 2 + 0.1 * 2, 3, 0.5},
                                 Pose{1.1, 2, 3, 0.5}, Pose{1.1, 2.1, 3, 0.5}));
  EXPECT_EQ(crowd.size(), 5u);
}

TEST(Placement, GridSkipsWhatIsTaken) {
  const partition::StaticScene scene(
      {{box({0, 1}, {0.5, 0.5}), BodyId(1)}, {box({0, 3}, {0.5, 0.5}, {2, 3}), BodyId(2)}}, 1);
  const partition::ObstacleShape shape = box_shape({0.5, 0.5});
  Crowd crowd;
  crowd.add(shape, {0.2, 0, 0, 0});
  const PlacementRule rule{.region = region(0, 0, 0, 5), .pitch_m = 1, .heading = 0};
  const auto poses = place(rule, shape, 10, 1, "p", region(-9, -9, 9, 4.5), scene, crowd, one_thread());
  // (0, 0) holds the other body, (0, 1) a wall, (0, 3) a wall above head height; (0, 5) is out of bounds.
  EXPECT_THAT(poses, ElementsAre(Pose{0, 2, 0, 0}, Pose{0, 3, 0, 0}, Pose{0, 4, 0, 0}));
}

TEST(Placement, AFullGridSpills) {
  const PlacementRule rule{
      .region = region(0, 0, 0, 1), .spill = region(-1, 0, 0, 1), .pitch_m = 1, .heading = 0};
  EXPECT_EQ(grid_cells(rule), 2 + 4);
  Crowd crowd;
  const auto poses = place(rule, box_shape({0.5, 0.5}), 9, 1, "p", std::nullopt, {}, crowd, one_thread());
  // The spill covers the region: what is taken there is passed over.
  EXPECT_THAT(poses, ElementsAre(Pose{0, 0, 0, 0}, Pose{0, 1, 0, 0}, Pose{-1, 0, 0, 0}, Pose{-1, 1, 0, 0}));
}

TEST(Placement, TouchingIsNotTaken) {
  Crowd crowd;
  const PlacementRule rule{.region = region(0, 0, 1, 1), .pitch_m = 0.5, .heading = 0};
  EXPECT_EQ(place(rule, box_shape({0.5, 0.5}), 100, 1, "p", std::nullopt, {}, crowd, one_thread()).size(),
            9u);
}

TEST(Placement, WhatIsNoObstacleIsNowhereInTheWay) {
  TypeSpec ghost;
  ghost.parts.push_back({.solids = {box({0, 0}, {1, 1})}, .returns = {.obstacle = false}});
  const partition::ObstacleShape none = obstacle_shape(ghost);
  EXPECT_TRUE(none.empty());
  const partition::StaticScene scene({{box({0, 0}, {9, 9}), BodyId(1)}}, 1);
  Crowd crowd;
  const PlacementRule rule{.region = region(0, 0, 0.1, 0.1), .pitch_m = 0.1, .heading = 0};
  EXPECT_EQ(place(rule, none, 4, 1, "p", std::nullopt, scene, crowd, one_thread()).size(), 4u);
  EXPECT_TRUE(crowd.free(box_shape({1, 1}), {}));
}

TEST(Placement, DrawsAreNamedBySeedAndPopulation) {
  const PlacementRule rule{.kind = PlacementRule::Kind::uniform, .region = region(0, 0, 100, 100)};
  const auto first = [&](std::uint64_t seed, std::string_view name) {
    Crowd crowd;
    return place(rule, box_shape({0.1, 0.1}), 1, seed, name, std::nullopt, {}, crowd, one_thread())[0];
  };
  EXPECT_EQ(first(1, "p"), first(1, "p"));
  EXPECT_NE(first(1, "p"), first(2, "p"));
  EXPECT_NE(first(1, "p"), first(1, "q"));
  EXPECT_NE(first(1, "p").heading, 0);
}

TEST(Placement, AFixedHeadingMovesNobody) {
  PlacementRule rule{.region = region(0, 0, 9, 9), .pitch_m = 1, .jitter_m = 0.2};
  Crowd crowd_a, crowd_b;
  const auto a = place(rule, box_shape({0.1, 0.1}), 20, 1, "p", std::nullopt, {}, crowd_a, one_thread());
  rule.heading = 1;
  const auto b = place(rule, box_shape({0.1, 0.1}), 20, 1, "p", std::nullopt, {}, crowd_b, one_thread());
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(a[i].position(), b[i].position());
}

/// Enough bodies, walls and refusals that several blocks of candidates are looked at ahead.
TEST(Placement, ThreadsChangeNobodysPlace) {
  std::vector<partition::FixedSolid> walls;
  Random random(1, 2, 3, 4);
  for (std::size_t i = 1; i <= 40; ++i)
    walls.push_back({box({random.uniform(0, 20), random.uniform(0, 20)}, {0.3, 4}), BodyId(i)});
  const partition::StaticScene scene(walls, 0.5);
  const partition::ObstacleShape shape = box_shape({0.1, 0.1});
  const PlacementRule uniform{.kind = PlacementRule::Kind::uniform, .region = region(0, 0, 20, 20)};
  const PlacementRule grid{.region = region(0, 0, 20, 20), .pitch_m = 0.12, .heading = 0.1};
  const PlacementRule drawn{.region = region(0, 0, 20, 20), .pitch_m = 0.12, .jitter_m = 0.05};
  constexpr std::size_t k_bodies = test::k_slow_build ? 3000 : 12000;

  std::vector<Pose> one_by_one;  // the rule of `uniform`, as it is defined
  Crowd crowd;
  for (std::uint32_t body = 0; body < k_bodies; ++body)
    for (std::uint32_t trial = 0; trial < uniform.trials; ++trial) {
      Random draws(1, stream_id("place", "p"), body, trial);
      Pose pose{draws.uniform() * 20, draws.uniform() * 20, 0, 0};
      pose.heading = draws.uniform(-k_pi, k_pi);
      if (scene.blocked(shape, pose) || !crowd.free(shape, pose)) continue;
      crowd.add(shape, pose);
      one_by_one.push_back(pose);
      break;
    }
  ASSERT_EQ(one_by_one.size(), k_bodies);

  for (const PlacementRule& rule : {uniform, grid, drawn}) {
    std::vector<Pose> expected = one_by_one;
    for (const unsigned threads : {1u, 2u, 3u, 8u}) {
      partition::Parallel parallel(threads);
      Crowd others;
      const auto poses = place(rule, shape, k_bodies, 1, "p", std::nullopt, scene, others, parallel);
      if (threads == 1 && rule.kind == PlacementRule::Kind::grid) expected = poses;
      EXPECT_EQ(poses, expected) << threads << " threads";
      EXPECT_EQ(others.size(), poses.size());
      EXPECT_GT(poses.size(), k_bodies * 5 / 12);
    }
  }
}

RC_GTEST_PROP(PlacementProperty, NobodyOverlaps, ()) {
  const Setting s = any_setting();
  const auto poses = s.placed(60);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) RC_ASSERT(depth(s.size, poses[j], s.size, poses[i]) < k_touch);
    for (const auto& [size, pose] : s.walls) RC_ASSERT(depth(size, pose, s.size, poses[i]) < k_touch);
    const Box within =
        s.rule.region.expanded(s.rule.kind == PlacementRule::Kind::grid ? s.rule.jitter_m + 1e-9 : 0);
    RC_ASSERT(within.contains(poses[i].position()));
    if (s.rule.heading) RC_ASSERT(poses[i].heading == *s.rule.heading);
  }
}

RC_GTEST_PROP(PlacementProperty, ABodysPlaceDependsOnNoCountAndNoCellSize, ()) {
  const Setting s = any_setting();
  const auto poses = s.placed(50);
  const auto fewer = s.placed(*rc::gen::inRange<std::size_t>(0, 50), any(0.1, 7));
  RC_ASSERT(fewer.size() <= poses.size());
  RC_ASSERT(std::equal(fewer.begin(), fewer.end(), poses.begin()));
}

RC_GTEST_PROP(PlacementProperty, TheGridTakesEveryFreeCellInOrder, ()) {
  Setting s = any_setting();
  s.rule.kind = PlacementRule::Kind::grid;
  s.rule.pitch_m = any(0.4, 1.2);  // the oracle looks at every pair
  s.rule.jitter_m = 0;
  s.rule.heading = any(-3, 3);
  const auto poses = s.placed(10000);

  std::vector<Pose> expected;
  const Vec2 extent = s.rule.region.size();
  for (int column = 0; column * s.rule.pitch_m <= extent.x(); ++column)
    for (int row = 0; row * s.rule.pitch_m <= extent.y(); ++row) {
      const Pose pose{s.rule.region.min.x() + column * s.rule.pitch_m,
                      s.rule.region.min.y() + row * s.rule.pitch_m, 0, *s.rule.heading};
      double deepest = -1;
      for (const auto& [size, wall] : s.walls) deepest = std::max(deepest, depth(size, wall, s.size, pose));
      for (const Pose& other : expected) deepest = std::max(deepest, depth(s.size, other, s.size, pose));
      RC_PRE(std::abs(deepest) > k_touch);  // undecided
      if (deepest < 0) expected.push_back(pose);
    }
  RC_ASSERT(poses.size() == expected.size());
  for (std::size_t i = 0; i < poses.size(); ++i)
    RC_ASSERT((poses[i].position() - expected[i].position()).norm() < 1e-12);
}

RC_GTEST_PROP(CrowdProperty, FindsWhatEveryPairFinds, ()) {
  struct Body {
    partition::ObstacleShape shape;
    Pose pose;
  };
  std::vector<Body> bodies;
  for (int i = *rc::gen::inRange(1, 60); i > 0; --i) {
    const double width = std::exp2(any(-12, 5));  // a millimetre to a truck
    const double reach = *rc::gen::element(0.01, 1.0, 30.0);
    bodies.push_back({box_shape({width, width * any(0.2, 1)}, {0, any(0.1, 2)}),
                      {any(-reach, reach), any(-reach, reach), any(0, 1), any(-4, 4)}});
  }
  Crowd crowd;
  for (const Body& body : bodies) {
    std::vector<std::size_t> expected;
    for (std::size_t i = 0; i < crowd.size(); ++i)
      if (partition::overlap(bodies[i].shape, bodies[i].pose, body.shape, body.pose)) expected.push_back(i);
    RC_ASSERT(crowd.overlapping(body.shape, body.pose) == expected);
    RC_ASSERT(crowd.free(body.shape, body.pose) == expected.empty());
    crowd.add(body.shape, body.pose);
  }
}

}  // namespace
}  // namespace troupe::engine
