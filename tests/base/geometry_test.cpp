#include "base/geometry.hpp"

#include <gtest/gtest.h>

namespace troupe::geometry_test {
namespace {

TEST(Cross, IsPositiveCounterClockwise) {
  EXPECT_EQ(cross({1, 0}, {0, 2}), 2.0);
  EXPECT_EQ(cross({0, 2}, {1, 0}), -2.0);
  EXPECT_EQ(cross({1, 2}, {2, 4}), 0.0);
}

TEST(CrossesRay, AnEndAtTheHeightOfThePointCountsAsBelow) {
  EXPECT_TRUE(crosses_ray({1, -1}, {2, 1}, {0, 0}));
  EXPECT_TRUE(crosses_ray({2, 1}, {1, -1}, {0, 0}));
  EXPECT_FALSE(crosses_ray({-2, -1}, {-1, 1}, {0, 0}));  // to the left
  EXPECT_FALSE(crosses_ray({1, 1}, {2, 2}, {0, 0}));
  EXPECT_FALSE(crosses_ray({1, 0}, {2, 0}, {0, 0}));
  EXPECT_TRUE(crosses_ray({1, 0}, {2, 1}, {0, 0}));
  EXPECT_FALSE(crosses_ray({1, 0}, {2, -1}, {0, 0}));
}

TEST(SquaredDistanceToSegment, IsThatToItsNearestPoint) {
  const Vec2 a(1, 1);
  const Vec2 b(5, 4);
  EXPECT_EQ(squared_distance_to_segment({3, 2.5}, a, b), 0) << "on the segment";
  EXPECT_EQ(squared_distance_to_segment({0, 6.5}, a, b), 25) << "at right angles to its middle";
  EXPECT_EQ(squared_distance_to_segment({0, 6.5}, b, a), 25);
  EXPECT_EQ(squared_distance_to_segment({-2, -3}, a, b), 25) << "beyond a";
  EXPECT_EQ(squared_distance_to_segment({8, 8}, a, b), 25) << "beyond b";
}

TEST(SquaredDistanceToSegment, ToASegmentWithoutLengthIsThatToItsEnd) {
  const Vec2 a(1, 1);
  EXPECT_EQ(squared_distance_to_segment({4, 5}, a, a), 25);
  EXPECT_EQ(squared_distance_to_segment({0, 5}, {0, 0}, {1e-200, 0}), 25) << "its squared length underflows";
}

TEST(ZInterval, IsClosedForPointsAndOpenForOverlap) {
  const ZInterval z = {1, 2};
  EXPECT_TRUE(z.contains(1) && z.contains(1.5) && z.contains(2));
  EXPECT_FALSE(z.contains(0.999) || z.contains(2.001));
  EXPECT_TRUE(z.overlaps({1.5, 3}) && z.overlaps({0, 5}) && z.overlaps({1.2, 1.3}));
  EXPECT_FALSE(z.overlaps({2, 3}) || z.overlaps({0, 1}) || z.overlaps({3, 4}));
  EXPECT_EQ(z.shifted(0.5), (ZInterval{1.5, 2.5}));
}

TEST(Box, IsEmptyUntilExtended) {
  Box box;
  EXPECT_TRUE(box.empty());
  EXPECT_FALSE(box.contains({0, 0}));
  EXPECT_FALSE(box.touches(Box::around({0, 0}, 1e9)));
  box.extend(Box());
  EXPECT_TRUE(box.empty());
  box.extend(Vec2(1, 2));
  EXPECT_FALSE(box.empty());
  EXPECT_EQ(box.size(), Vec2(0, 0));
  box.extend(Vec2(-1, 4));
  EXPECT_EQ(box.size(), Vec2(2, 2));
  EXPECT_EQ(box.center(), Vec2(0, 3));
}

TEST(Box, IsClosed) {
  const Box box = Box::around({1, 1}, 1);
  EXPECT_TRUE(box.contains({0, 2}));
  EXPECT_FALSE(box.contains({-1e-9, 1}));
  EXPECT_TRUE(box.touches(Box::around({3, 3}, 1)));
  EXPECT_FALSE(box.touches(Box::around({3.1, 1}, 1)));
  EXPECT_TRUE(box.touches(box.expanded(-0.9)));
  EXPECT_EQ(box.expanded(0.5).min, Vec2(-0.5, -0.5));
  EXPECT_EQ(box.expanded(0.5).max, Vec2(2.5, 2.5));
}

}  // namespace
}  // namespace troupe::geometry_test
