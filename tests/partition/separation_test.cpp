#include "partition/separation.hpp"

#include "tests/engine/conflict_crowds.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

namespace troupe::partition::separation_test {
namespace {

using oracle::Draw;
using oracle::rectangle;

Pose shifted(const Pose& pose, const Vec2& by) {
  return {pose.x + by.x(), pose.y + by.y(), pose.z, pose.heading};
}

TEST(WayOut, IsTheShortestWayThatSeparates) {
  std::uint64_t overlapping = 0;
  constexpr std::uint64_t k_pairs = 3000 / oracle::k_thrift;
  for (std::uint64_t seed = 1; seed <= k_pairs; ++seed) {
    Draw draw(seed);
    const auto convex = [&] {
      const Ring ring = oracle::random_star(draw, 3 + draw.below(6), draw.scale(0.1, 1), 1);
      return make_obstacle_shape(std::vector<ConvexPrism>{{ring, {0, 1}}});
    };
    const double far = draw.chance(0.3) ? 9e4 : 0;
    const ObstacleShape a = convex();
    const ObstacleShape b = convex();
    const Pose at_a{far, -far, 0, draw.real(-4, 4)};
    const Pose at_b{far + draw.real(-1, 1), -far + draw.real(-1, 1), 0, draw.real(-4, 4)};
    const std::optional<Vec2> way = way_out(PlacedShape(a, at_a), PlacedShape(b, at_b));
    ASSERT_EQ(way.has_value(), overlap(a, at_a, b, at_b)) << "seed " << seed;
    if (!way) continue;
    ++overlapping;
    constexpr double k_margin = 1e-9;
    const double length = way->norm();
    EXPECT_FALSE(overlap(a, at_a, b, shifted(at_b, (1 + k_margin / length) * *way))) << "seed " << seed;
    for (int turn = 0; turn < 64; ++turn) {
      const double angle = turn * k_pi / 32;
      const Vec2 shorter = (0.99 * length - k_margin) * Vec2(std::cos(angle), std::sin(angle));
      EXPECT_TRUE(overlap(a, at_a, b, shifted(at_b, shorter))) << "seed " << seed << ", turn " << turn;
    }
  }
  EXPECT_GT(overlapping, k_pairs / 5);
  EXPECT_LT(overlapping, k_pairs * 9 / 10);
}

TEST(WayOut, IsThatOfThePiecesThatPenetrateMostDeeply) {
  const ObstacleShape bar = make_obstacle_shape(std::vector<ConvexPrism>{{rectangle(-5, -1, 5, 1), {0, 1}}});
  const ObstacleShape feet = make_obstacle_shape(
      std::vector<ConvexPrism>{{rectangle(-4, 0.75, -3, 3), {0, 1}}, {rectangle(3, 0.5, 4, 3), {0, 1}}});
  EXPECT_EQ(way_out(PlacedShape(bar, Pose{}), PlacedShape(feet, Pose{})), Vec2(0, 0.5));
  EXPECT_EQ(way_out(PlacedShape(feet, Pose{}), PlacedShape(bar, Pose{})), Vec2(0, -0.5));
  EXPECT_EQ(way_out(PlacedShape(bar, Pose{}), PlacedShape(feet, Pose{0, 0, 1, 0})), std::nullopt)
      << "no common height";
  EXPECT_EQ(way_out(PlacedShape(bar, Pose{}), PlacedShape(feet, Pose{0, 0.5, 0, 0})), std::nullopt)
      << "they only touch";
}

// If every piece were compared with every piece, this test would run for minutes.
TEST(WayOut, ComparesOnlyPiecesThatAreNear) {
  constexpr int k_pieces = 40'000;
  const ObstacleShape fence = oracle::fence_of(k_pieces);
  EXPECT_EQ(way_out(PlacedShape(fence, Pose{}), PlacedShape(fence, Pose{k_pieces - 0.75, 0, 0, 0})),
            Vec2(0.25, 0));
}

}  // namespace
}  // namespace troupe::partition::separation_test
