#include "engine/spec/placement.hpp"

#include "base/math.hpp"
#include "base/random.hpp"
#include "tests/support/slow_build.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <cmath>

namespace troupe::engine::placement_test {
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
    return place({.rule = rule,
                  .shape = box_shape(size),
                  .count = count,
                  .seed = seed,
                  .population = "p",
                  .scene = scene(cell_m)},
                 crowd, one_thread());
  }
};

double any(double low, double high) { return low + (high - low) * (*rc::gen::inRange(0, 1000001) / 1e6); }

Setting any_setting() {
  Setting s;
  for (int i = *rc::gen::inRange(0, 8); i > 0; --i)
    s.walls.push_back({{any(0.02, 3), any(0.02, 3)}, {any(-5, 5), any(-5, 5), 0, any(-4, 4)}});
  s.size = {any(0.05, 0.8), any(0.05, 0.8)};
  using enum PlacementRule::Kind;
  s.rule.kind = *rc::gen::element(grid, uniform, gaussian, poisson_disc, free_floor);
  s.rule.distance_m = any(0.1, 1);
  s.rule.region = region(any(-5, -1), any(-5, -1), any(0, 4), any(0, 4));
  s.rule.pitch_m = any(0.2, 1.2);
  s.rule.jitter_m = *rc::gen::element(0.0, 0.1, 0.7);
  if (*rc::gen::arbitrary<bool>()) s.rule.heading = any(-3, 3);
  s.rule.trials = 50;
  s.seed = *rc::gen::arbitrary<std::uint64_t>();
  return s;
}

std::vector<Pose> placed(const PlacementRule& rule, std::size_t count,
                         const partition::StaticScene& scene = {}, Size size = {0.1, 0.1}) {
  Crowd crowd;
  return place(
      {.rule = rule, .shape = box_shape(size), .count = count, .seed = 1, .population = "p", .scene = scene},
      crowd, one_thread());
}

TEST(Placement, GridFillsColumnByColumn) {
  const PlacementRule rule{.region = region(1, 2, 1.3, 2.2), .pitch_m = 0.1, .heading = 0.5, .z = 3};
  EXPECT_EQ(grid_cells(rule), 4 * 3);
  Crowd crowd;
  const auto poses = place(
      {.rule = rule, .shape = box_shape({0.01, 0.01}), .count = 5, .seed = 1, .population = "p", .scene = {}},
      crowd, one_thread());
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
  const auto poses = place({.rule = rule,
                            .shape = shape,
                            .count = 10,
                            .seed = 1,
                            .population = "p",
                            .bounds = region(-9, -9, 9, 4.5),
                            .scene = scene},
                           crowd, one_thread());
  // (0, 0) holds the other body, (0, 1) a wall, (0, 3) a wall above head height; (0, 5) is out of bounds.
  EXPECT_THAT(poses, ElementsAre(Pose{0, 2, 0, 0}, Pose{0, 3, 0, 0}, Pose{0, 4, 0, 0}));
}

TEST(Placement, AFullGridSpills) {
  const PlacementRule rule{
      .region = region(0, 0, 0, 1), .spill = region(-1, 0, 0, 1), .pitch_m = 1, .heading = 0};
  EXPECT_EQ(grid_cells(rule), 2 + 4);
  const auto poses = placed(rule, 9, {}, {0.5, 0.5});
  // The spill covers the region: what is taken there is passed over.
  EXPECT_THAT(poses, ElementsAre(Pose{0, 0, 0, 0}, Pose{0, 1, 0, 0}, Pose{-1, 0, 0, 0}, Pose{-1, 1, 0, 0}));
}

TEST(Placement, TouchingIsNotTaken) {
  const PlacementRule rule{.region = region(0, 0, 1, 1), .pitch_m = 0.5, .heading = 0};
  EXPECT_EQ(placed(rule, 100, {}, {0.5, 0.5}).size(), 9u);
}

TEST(Placement, WhatIsNoObstacleIsNowhereInTheWay) {
  TypeSpec ghost;
  ghost.parts.push_back({.solids = {box({0, 0}, {1, 1})}, .returns = {.obstacle = false}});
  const partition::ObstacleShape none = obstacle_shape(ghost);
  EXPECT_TRUE(none.empty());
  const partition::StaticScene scene({{box({0, 0}, {9, 9}), BodyId(1)}}, 1);
  Crowd crowd;
  const PlacementRule rule{.region = region(0, 0, 0.1, 0.1), .pitch_m = 0.1, .heading = 0};
  EXPECT_EQ(place({.rule = rule, .shape = none, .count = 4, .seed = 1, .population = "p", .scene = scene},
                  crowd, one_thread())
                .size(),
            4u);
  EXPECT_TRUE(crowd.free(box_shape({1, 1}), {}));
}

TEST(Placement, DrawsAreNamedBySeedAndPopulation) {
  const PlacementRule rule{.kind = PlacementRule::Kind::uniform, .region = region(0, 0, 100, 100)};
  const auto first = [&](std::uint64_t seed, std::string_view name) {
    Crowd crowd;
    return place({.rule = rule,
                  .shape = box_shape({0.1, 0.1}),
                  .count = 1,
                  .seed = seed,
                  .population = name,
                  .scene = {}},
                 crowd, one_thread())[0];
  };
  EXPECT_EQ(first(1, "p"), first(1, "p"));
  EXPECT_NE(first(1, "p"), first(2, "p"));
  EXPECT_NE(first(1, "p"), first(1, "q"));
  EXPECT_NE(first(1, "p").heading, 0);
}

TEST(Placement, AFixedHeadingMovesNoRobot) {
  PlacementRule rule{.region = region(0, 0, 9, 9), .pitch_m = 1, .jitter_m = 0.2};
  const auto a = placed(rule, 20);
  rule.heading = 1;
  const auto b = placed(rule, 20);
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(a[i].position(), b[i].position());
}

/// Enough bodies, walls and refusals that several blocks of candidates are looked at ahead.
TEST(Placement, ThreadsChangeNoPlacement) {
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

  const PlacementRule spaced{
      .kind = PlacementRule::Kind::poisson_disc, .region = region(0, 0, 20, 20), .distance_m = 0.12};
  const PlacementRule floor{.kind = PlacementRule::Kind::free_floor, .region = region(0, 0, 20, 20)};

  for (const PlacementRule& rule : {uniform, grid, drawn, spaced, floor}) {
    std::vector<Pose> expected = one_by_one;
    for (const unsigned threads : {1u, 2u, 3u, 8u}) {
      partition::Parallel parallel(threads);
      Crowd others;
      const auto poses = place(
          {.rule = rule, .shape = shape, .count = k_bodies, .seed = 1, .population = "p", .scene = scene},
          others, parallel);
      if (threads == 1 && rule.kind != PlacementRule::Kind::uniform) expected = poses;
      EXPECT_EQ(poses, expected) << threads << " threads";
      EXPECT_EQ(others.size(), poses.size());
      EXPECT_GT(poses.size(), k_bodies * 5 / 12);
    }
  }
}

TEST(Placement, APolygonHoldsThemWhateverTheRule) {
  const Ring triangle{{0, 0}, {4, 0}, {0, 4}};
  const auto is_in = [](const Pose& pose) { return pose.x > 0 && pose.y > 0 && pose.x + pose.y < 4; };
  PlacementRule rule{.kind = PlacementRule::Kind::uniform, .region = region(0, 0, 4, 4), .polygon = triangle};
  for (const Pose& pose : placed(rule, 200)) EXPECT_TRUE(is_in(pose));
  rule.kind = PlacementRule::Kind::gaussian;
  rule.mean = {3, 3};
  for (const Pose& pose : placed(rule, 50)) EXPECT_TRUE(is_in(pose));
  const PlacementRule grid{.region = region(0.6, 0.6, 4, 4), .polygon = triangle, .pitch_m = 1, .heading = 0};
  EXPECT_EQ(placed(grid, 100).size(), 3u + 2 + 1);
}

TEST(Placement, GaussianHasItsMeanAndDeviations) {
  const PlacementRule rule{.kind = PlacementRule::Kind::gaussian,
                           .region = region(-1000, -1000, 1000, 1000),
                           .mean = {100, -50},
                           .deviation = {20, 5}};
  constexpr double k_count = 2000;
  const auto poses = placed(rule, static_cast<std::size_t>(k_count), {}, {0.01, 0.01});
  ASSERT_EQ(poses.size(), k_count);
  Vec2 sum(0, 0), squares(0, 0);
  for (const Pose& pose : poses) sum += pose.position();
  const Vec2 mean = sum / k_count;
  for (const Pose& pose : poses) squares += (pose.position() - mean).cwiseAbs2();
  const Vec2 deviation = (squares / (k_count - 1)).cwiseSqrt();
  // Within four standard errors, s / sqrt(n) of the mean and s / sqrt(2 n) of the deviation.
  EXPECT_NEAR(mean.x(), 100, 4 * 20 / std::sqrt(k_count));
  EXPECT_NEAR(mean.y(), -50, 4 * 5 / std::sqrt(k_count));
  EXPECT_NEAR(deviation.x(), 20, 4 * 20 / std::sqrt(2 * k_count));
  EXPECT_NEAR(deviation.y(), 5, 4 * 5 / std::sqrt(2 * k_count));
}

TEST(Placement, OfAPoissonDiscNoTwoAreNear) {
  const PlacementRule rule{
      .kind = PlacementRule::Kind::poisson_disc, .region = region(0, 0, 10, 10), .distance_m = 1};
  const auto poses = placed(rule, 1000);
  // Discs thrown until a thousand find no room cover about half of the plane: 0.5 * 100 / (pi / 4) of them,
  // and more as those at the border reach over it.
  EXPECT_GT(poses.size(), 60u);
  EXPECT_LT(poses.size(), 90u);
  for (std::size_t i = 0; i < poses.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      ASSERT_GE((poses[i].position() - poses[j].position()).norm(), 1) << i << " and " << j;
}

/// Two rooms with a gap of 1 m between them, and a third that nothing leads to.
partition::StaticScene rooms() {
  return {{{box({0, 1}, {0.2, 5}), BodyId(1)},     // x 0, y -1.5 .. 3.5: the gap is below
           {box({-2, 3.4}, {4, 0.2}), BodyId(2)},  // round both rooms, y 3.4 ..
           {box({2, 3.4}, {4, 0.2}), BodyId(3)},   // .. -2.6
           {box({0, -2.6}, {8.2, 0.2}), BodyId(4)},
           {box({-4, 0.4}, {0.2, 6.2}), BodyId(5)},
           {box({4, 0.4}, {0.2, 6.2}), BodyId(6)}},
          0.5};
}

TEST(Placement, TheFreeFloorIsWhatABodyCanReach) {
  const partition::StaticScene scene = rooms();
  PlacementRule rule{
      .kind = PlacementRule::Kind::free_floor, .region = region(-4, -2.6, 20, 3.4), .from = Vec2(-2, 0)};
  const auto mean_of_signs = [](const std::vector<Pose>& poses) {
    double sum = 0;
    for (const Pose& pose : poses) sum += pose.x < 0 ? -1 : 1;
    return sum / static_cast<double>(poses.size());
  };
  const auto small = placed(rule, 100, scene, {0.2, 0.2});
  ASSERT_EQ(small.size(), 100u);
  for (const Pose& pose : small) EXPECT_LT(pose.x, 3.9) << "the floor outside is not reached";
  EXPECT_LT(std::abs(mean_of_signs(small)), 0.5) << "both rooms";
  const auto large = placed(rule, 5, scene, {1.1, 1.1});
  ASSERT_EQ(large.size(), 5u);
  for (const Pose& pose : large) EXPECT_LT(pose.x, 0) << "too wide for the gap";
  rule.from.reset();
  for (const Pose& pose : placed(rule, 20, scene, {0.2, 0.2})) EXPECT_GT(pose.x, 4.1) << "it is the largest";
  rule.from = Vec2(0, 1);
  EXPECT_TRUE(placed(rule, 1, scene, {0.2, 0.2}).empty()) << "in a wall";
}

RC_GTEST_PROP(PlacementProperty, NoBodiesOverlap, ()) {
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
    const auto all = [](std::size_t) { return true; };
    const auto odd = [](std::size_t i) { return i % 2 == 1; };
    RC_ASSERT(crowd.overlapping(body.shape, body.pose, all) == expected);
    std::vector<std::size_t> expected_odd;
    std::ranges::copy_if(expected, std::back_inserter(expected_odd), odd);
    RC_ASSERT(crowd.overlapping(body.shape, body.pose, odd) == expected_odd);
    RC_ASSERT(crowd.free(body.shape, body.pose) == expected.empty());
    crowd.add(body.shape, body.pose);
  }
}

}  // namespace
}  // namespace troupe::engine::placement_test
