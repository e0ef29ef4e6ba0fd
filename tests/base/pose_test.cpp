#include "base/pose.hpp"

#include <gtest/gtest.h>

namespace troupe::pose_test {
namespace {

constexpr double k_tolerance = 1e-15;

TEST(Rotation, TurnsCounterClockwise) {
  const Vec2 v = Rotation(k_pi / 2) * Vec2(2, 1);
  EXPECT_NEAR(v.x(), -1, k_tolerance);
  EXPECT_NEAR(v.y(), 2, k_tolerance);
  EXPECT_EQ(Rotation() * Vec2(2, 1), Vec2(2, 1));
}

TEST(Transform, TurnsThenMoves) {
  const Vec2 p = Transform(Pose{10, 20, 5, k_pi}) * Vec2(2, 1);
  EXPECT_NEAR(p.x(), 8, 1e-14);
  EXPECT_NEAR(p.y(), 19, 1e-14);
}

TEST(Compose, PlacesTheInnerFrameInTheOuter) {
  const Pose pose = compose({1, 2, 3, k_pi / 2}, {4, 5, 6, 0.25});
  EXPECT_NEAR(pose.x, 1 - 5, k_tolerance * 8);
  EXPECT_NEAR(pose.y, 2 + 4, k_tolerance * 8);
  EXPECT_EQ(pose.z, 9);
  EXPECT_EQ(pose.heading, k_pi / 2 + 0.25);
}

TEST(Compose, WrapsTheHeading) {
  EXPECT_NEAR(compose({0, 0, 0, 3}, {0, 0, 0, 3}).heading, 6 - 2 * k_pi, k_tolerance);
  EXPECT_NEAR(compose({0, 0, 0, -3}, {0, 0, 0, -3}).heading, 2 * k_pi - 6, k_tolerance);
}

TEST(Compose, TheDefaultPoseChangesNothing) {
  const Pose pose = {1.1, -2.2, 3.3, -0.7};
  EXPECT_EQ(compose(Pose{}, pose), pose);
  EXPECT_EQ(compose(pose, Pose{}), pose);
}

}  // namespace
}  // namespace troupe::pose_test
