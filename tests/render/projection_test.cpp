#include "render/projection.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace troupe::render::projection_test {
namespace {

std::vector<Vec3> corners(const Vec3& min, const Vec3& max) {
  std::vector<Vec3> points;
  for (const double x : {min.x(), max.x()})
    for (const double y : {min.y(), max.y()})
      for (const double z : {min.z(), max.z()}) points.emplace_back(x, y, z);
  return points;
}

/// Where OpenGL puts a point: pixels about the middle, and its depth from -1 to 1.
Vec3 by_matrix(const Projection& view, const Vec3& point) {
  const std::array<float, 16> m = view.clip_matrix();
  const Vec3 p = point - view.origin();
  std::array<double, 4> clip{};
  for (std::size_t row = 0; row < 4; ++row)
    clip[row] = m[row] * p.x() + m[4 + row] * p.y() + m[8 + row] * p.z() + m[12 + row];
  return {clip[0] / clip[3] * view.width() / 2, clip[1] / clip[3] * view.height() / 2, clip[2] / clip[3]};
}

struct Case {
  double pitch, yaw, fov;
};

class AnyView : public ::testing::TestWithParam<Case> {
 protected:
  Projection view(int width = 1280, int height = 720) const {
    return {width, height, 1, GetParam().pitch, GetParam().yaw, GetParam().fov};
  }
};

TEST_P(AnyView, FitsAllPointsAndIsFilledByThem) {
  const std::vector<Vec3> points = corners({20, -40, 0}, {160, 20, 2});
  for (const auto& [width, height] : {std::pair(1280, 720), std::pair(400, 900)}) {
    Projection projection = view(width, height);
    projection.fit(points, 20, 30);
    projection.reach(points);
    double left = 0, right = 0, top = 0, bottom = 0;
    for (const Vec3& point : points) {
      const auto place = projection.to_pixels(point);
      ASSERT_TRUE(place);
      left = std::min(left, place->x());
      right = std::max(right, place->x());
      bottom = std::min(bottom, place->y());
      top = std::max(top, place->y());
    }
    EXPECT_LE(right, width / 2.0 - 20 + 1e-6);
    EXPECT_GE(left, -width / 2.0 + 20 - 1e-6);
    EXPECT_LE(top, height / 2.0 - 20 + 1e-6);
    EXPECT_GE(bottom, -height / 2.0 + 50 - 1e-6);
    const bool fills_width = right - left > width - 40 - 0.01 * width;
    const bool fills_height = top - bottom > height - 70 - 0.01 * height;
    EXPECT_TRUE(fills_width || fills_height) << right - left << " x " << top - bottom;
  }
}

TEST_P(AnyView, TheMatrixSaysTheSame) {
  const std::vector<Vec3> points = corners({1000, -40, 0}, {1016, 20, 2});
  Projection projection = view();
  projection.fit(points, 20, 30);
  projection.reach(points);
  for (const Vec3& point : points) {
    const auto place = projection.to_pixels(point);
    const Vec3 drawn = by_matrix(projection, point);
    ASSERT_TRUE(place);
    EXPECT_NEAR(drawn.x(), place->x(), 0.02);
    EXPECT_NEAR(drawn.y(), place->y(), 0.02);
    EXPECT_GT(drawn.z(), -1);
    EXPECT_LT(drawn.z(), 1);
  }
}

TEST_P(AnyView, WhatIsNearerIsLessDeep) {
  const std::vector<Vec3> points = corners({-5, -5, 0}, {5, 5, 1});
  Projection projection = view();
  projection.fit(points, 0, 0);
  projection.reach(points);
  const Vec3 far = {1, 1, 0.2};
  const Vec3 near = far + 0.05 * projection.back();
  EXPECT_LT(projection.depth(near), projection.depth(far));
  EXPECT_LT(by_matrix(projection, near).z(), by_matrix(projection, far).z());
  // The bias is worth a few pixels, not the size of things.
  const double pixel = 1 / projection.pixels_per_metre(far);
  const Vec3 nearer = far + 10 * pixel * projection.back();
  const double w = projection.perspective() ? projection.depth(far) : 1;
  EXPECT_LT(projection.clip_bias(), 0);
  EXPECT_GT(by_matrix(projection, far).z() + projection.clip_bias() / w, by_matrix(projection, nearer).z());
}

TEST_P(AnyView, LinesAreNotMovedBeyondTheNearPlane) {
  const std::vector<Vec3> points = corners({-8000, -4000, 0}, {8000, 4000, 0.5});
  Projection projection = view();
  projection.fit(points, 0, 0);
  projection.reach(points);
  for (const Vec3& point : points) {
    const double w = projection.perspective() ? projection.depth(point) : 1;
    EXPECT_GT(by_matrix(projection, point).z() + projection.clip_bias() / w, -1);
  }
}

TEST_P(AnyView, LooksAtWhatItIsToldTo) {
  Projection projection = view();
  projection.look_at({30, 40, 0}, 16);
  projection.reach(corners({20, 30, 0}, {40, 50, 1}));
  const auto middle = projection.to_pixels({30, 40, 0});
  ASSERT_TRUE(middle);
  EXPECT_NEAR(middle->norm(), 0, 1e-6);
  EXPECT_NEAR(projection.pixels_per_metre({30, 40, 0}), 1280 / 16.0, 1e-6);
  EXPECT_NEAR((projection.origin() - Vec3(30, 40, 0)).norm(), 0, 1e-9);
  EXPECT_NEAR((projection.floor_center() - Vec3(30, 40, 0)).norm(), 0, 1e-9);
}

TEST_P(AnyView, LeavesNothingOutThatCanBeSeen) {
  Projection projection = view();
  projection.look_at({0, 0, 0}, 10);
  projection.reach(corners({-20, -20, 0}, {20, 20, 1}));
  int shown = 0;
  int hidden = 0;
  for (double x = -20; x <= 20; x += 0.7) {
    for (double y = -20; y <= 20; y += 0.7) {
      const Vec3 point(x, y, 0.3);
      const auto place = projection.to_pixels(point);
      const bool in_picture = place && std::abs(place->x()) <= 640 && std::abs(place->y()) <= 360;
      EXPECT_TRUE(!in_picture || projection.may_show(point, 0)) << x << ", " << y;
      shown += in_picture;
      hidden += !projection.may_show(point, 0.5);
    }
  }
  EXPECT_GT(shown, 20);
  EXPECT_GT(hidden, 100);
}

TEST_P(AnyView, ACloseViewOfALargeWorldShowsItsTarget) {
  const std::vector<Vec3> world = corners({-5000, -5000, 0}, {5000, 5000, 1});
  Projection close = view();
  close.look_at({30, 40, 0}, 0.5);
  close.reach(world);
  EXPECT_NEAR(close.pixels_per_metre({30, 40, 0}), 1280 / 0.5, 1e-6);
  EXPECT_TRUE(close.may_show({30, 40, 0}, 0));
  if (!close.perspective()) return;
  Projection standing = view();
  standing.stand_at(Vec3(30, 40, 0) + 0.5 * standing.back());
  standing.reach(world);
  EXPECT_TRUE(standing.to_pixels({30, 40, 0}));
  // The near plane of a view that looks at something farther depends only on the world.
  Projection ordinary = view();
  ordinary.look_at({30, 40, 0}, 50);
  ordinary.reach(world);
  std::vector<double> depths;
  for (const Vec3& corner : world) depths.push_back(ordinary.depth(corner));
  const auto [nearest, farthest] = std::ranges::minmax(depths);
  EXPECT_DOUBLE_EQ(ordinary.nearest(), std::max(0.8 * nearest, 1.1 * farthest / 4000));
}

INSTANTIATE_TEST_SUITE_P(Projection, AnyView,
                         ::testing::Values(Case{0, 0, 0}, Case{0, 0, 0.6}, Case{0.9, 0, 0.6},
                                           Case{0.9, 2.5, 0.6}, Case{1.4, -1, 1.0}, Case{0.6, 0.4, 0}));

TEST(Projection, YawTurnsTheViewerCounterClockwise) {
  // Quarter of a turn: what was far (+y) is now on the right, and -x is far.
  Projection view(800, 800, 1, 0.8, k_pi / 2, 0.6);
  view.look_at({0, 0, 0}, 10);
  view.reach(corners({-3, -3, 0}, {3, 3, 1}));
  EXPECT_GT(view.to_pixels({0, 2, 0})->x(), 50);
  EXPECT_GT(view.to_pixels({-2, 0, 0})->y(), 30);
}

TEST(Projection, FromAboveIsTheFraming) {
  Framing framing{800, 400};
  framing.pixels_per_metre = 100;
  framing.center = {5, -7};
  const Projection view = Projection::from_above(framing);
  for (const Vec2& p : {Vec2(5, -7), Vec2(6.5, -8)}) {
    const Vec3 point(p.x(), p.y(), 1);
    EXPECT_NEAR((*view.to_pixels(point) - framing.to_pixels(p)).norm(), 0, 1e-9);
    EXPECT_NEAR(by_matrix(view, point).x(), framing.to_pixels(p).x(), 1e-3);
    EXPECT_NEAR(by_matrix(view, point).y(), framing.to_pixels(p).y(), 1e-3);
  }
}

TEST(Projection, FromAboveShowsAllHeights) {
  Framing framing{800, 400};
  framing.pixels_per_metre = 0.5;  // lines are moved nearer by 4 m
  const Projection view = Projection::from_above(framing);
  for (const double z : {-1000.0, 0.0, 3.0, 1000.0}) {
    const double depth = by_matrix(view, {20, 10, z}).z();
    EXPECT_LT(depth, 1) << z;
    EXPECT_GT(depth + view.clip_bias(), -1) << z;
  }
}

TEST(Projection, WhatIsBehindTheViewerHasNoPlace) {
  Projection view(800, 600, 1, k_pi / 2, 0, 0.8);
  view.stand_at({0, 0, 1});
  view.reach(corners({-5, 1, 0}, {5, 20, 2}));
  EXPECT_TRUE(view.to_pixels({0, 10, 1}));
  EXPECT_FALSE(view.to_pixels({0, -10, 1}));
  EXPECT_FALSE(view.may_show({0, -10, 1}, 1));
  EXPECT_EQ(view.pixels_per_metre({0, -10, 1}), 0);
}

}  // namespace
}  // namespace troupe::render::projection_test
