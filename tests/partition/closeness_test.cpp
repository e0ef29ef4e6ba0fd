#include "partition/closeness.hpp"

#include "tests/engine/conflict_crowds.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace troupe::partition::closeness_test {
namespace {

using oracle::rectangle;

ObstacleShape shape_of(const std::vector<Ring>& contours) {
  return make_obstacle_shape(convex_pieces({contours, {0, 1}}));
}

bool within(const ObstacleShape& a, const Pose& at_a, const ObstacleShape& b, const Pose& at_b,
            double distance) {
  const bool result = come_within(PlacedShape(a, at_a), PlacedShape(b, at_b), distance);
  EXPECT_EQ(come_within(PlacedShape(b, at_b), PlacedShape(a, at_a), distance), result);
  return result;
}

TEST(ComeWithin, MeasuresTheGapBetweenEdgesAndCorners) {
  const ObstacleShape square = shape_of({rectangle(-0.5, -0.5, 0.5, 0.5)});
  EXPECT_TRUE(within(square, {}, square, {1.25, 0.3, 0, 0}, 0.25));
  EXPECT_FALSE(within(square, {}, square, {1.25, 0.3, 0, 0}, 0.24));
  EXPECT_TRUE(within(square, {}, square, {4, 5, 0, 0}, 5));  // from corner to corner
  EXPECT_FALSE(within(square, {}, square, {4, 5, 0, 0}, 4.99));
  const double diagonal = std::sqrt(0.5);
  EXPECT_TRUE(within(square, {}, square, {1.5 + diagonal, 0, 0, k_pi / 4}, 1 + 1e-9));  // corner to edge
  EXPECT_FALSE(within(square, {}, square, {1.5 + diagonal, 0, 0, k_pi / 4}, 1 - 1e-9));
}

TEST(ComeWithin, ShapesThatTouchOrOverlapHaveTheDistance0) {
  const ObstacleShape square = shape_of({rectangle(-0.5, -0.5, 0.5, 0.5)});
  const ObstacleShape dot = shape_of({rectangle(-0.1, -0.1, 0.1, 0.1)});
  const ObstacleShape bar = shape_of({rectangle(-2, -0.1, 2, 0.1)});
  EXPECT_TRUE(within(square, {}, square, {1, 0.5, 0, 0}, 0));
  EXPECT_TRUE(within(square, {}, square, {}, 0));
  EXPECT_TRUE(within(square, {}, dot, {0.2, 0.3, 0, 1}, 0)) << "inside";
  EXPECT_TRUE(within(square, {}, bar, {}, 0)) << "edges that cross, and no corner inside";
  EXPECT_TRUE(within(square, {}, dot, {0.2, 0.3, 7, 1}, 0)) << "heights are ignored";
}

TEST(ComeWithin, TestsEveryPiece) {
  const ObstacleShape fork = shape_of({rectangle(-1, -1, 1, -0.8), rectangle(-1, 0.8, 1, 1)});
  const ObstacleShape dot = shape_of({rectangle(-0.1, -0.1, 0.1, 0.1)});
  EXPECT_FALSE(within(fork, {}, dot, {}, 0.69));
  EXPECT_TRUE(within(fork, {}, dot, {0, 0.02, 0, 0}, 0.69));
  EXPECT_TRUE(within(fork, {}, dot, {0, -0.02, 0, 0}, 0.69));
  const ObstacleShape nothing = make_obstacle_shape({});
  EXPECT_FALSE(within(nothing, {}, dot, {}, 100));
}

// If every piece were compared with every piece, this test would run for minutes.
TEST(ComeWithin, ComparesOnlyPiecesThatAreNear) {
  constexpr int k_pieces = 40'000;
  const ObstacleShape fence = oracle::fence_of(k_pieces);
  EXPECT_FALSE(within(fence, {}, fence, {k_pieces, 0, 0, 0}, 0.49));  // the gap at the end is 0.5 m
  EXPECT_TRUE(within(fence, {}, fence, {k_pieces, 0, 0, 0}, 0.51));
}

// Rounding may change the direction of a very short edge. A shape inside the polygon of the edge is found all
// the same.
TEST(ComeWithin, EdgesShorterThanTheirRoundingHideNoShapeInside) {
  const ObstacleShape dot = shape_of({rectangle(-0.01, -0.01, 0.01, 0.01)});
  for (const double far : {0.0, 10.0, 1e3, 1e5})
    for (const double length : {1e-16, 1e-14, 1e-12, 1e-10}) {
      Ring corner = rectangle(-0.5, -0.5, 0.5, 0.5);
      corner.insert(corner.begin() + 2, {{0.5 + 0.5 * length, 0.5 - length}});
      const ObstacleShape pad = shape_of({corner});
      for (int turn = 0; turn < 64; ++turn) {
        const Pose pose{far, -far, 0, turn * k_pi / 32};
        for (const Vec2& at :
             {Vec2(0, 0), Vec2(0.4, 0.4), Vec2(-0.4, 0.4), Vec2(0.4, -0.4), Vec2(-0.4, -0.4)}) {
          const Vec2 there = Transform(pose) * at;
          EXPECT_TRUE(within(pad, pose, dot, {there.x(), there.y(), 0, pose.heading}, 0.005))
              << far << ' ' << length << ' ' << turn;
        }
      }
    }
}

}  // namespace
}  // namespace troupe::partition::closeness_test
