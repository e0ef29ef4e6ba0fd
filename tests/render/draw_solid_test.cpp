#include "render/draw.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <thread>
#include <utility>

namespace troupe::render::draw_solid_test {
namespace {

using engine::Frame;
using engine::FrameBody;
using engine::FrameScene;
using engine::FrameShape;
using engine::FrameType;

using Pixel = std::array<int, 3>;
constexpr Pixel k_paper = {250, 247, 240};
constexpr Color k_blue = {0, 0.2F, 0.8F, 1};
constexpr Color k_green = {0, 0.6F, 0, 1};
constexpr Pixel k_blue_pixel = {0, 51, 204};

Ring rectangle(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

FrameType box_type(double half, double height, bool mobile) {
  return {{FrameShape{Solid{{rectangle(-half, -half, half, half)}, {0, height}}, std::nullopt}},
          mobile,
          half * 1.4143};
}

bool is_blue(const Pixel& p) { return p[2] > p[0] + 40 && p[2] > p[1] + 40; }
bool is_green(const Pixel& p) { return p[1] > p[0] + 30 && p[1] > p[2] + 30; }

/// Robots of 1 x 1 x 1 m (type 0) around the origin, seen from the south from high up.
struct Yard {
  FrameScene scene;
  Frame frame;
  View view;
  Picture picture;

  Yard() {
    scene.types = {box_type(0.5, 1, true), box_type(0.5, 4, false)};
    scene.bounds = {{-8, -8}, {8, 8}};
    view.width = 640;
    view.height = 480;
    view.camera.perspective = true;
    view.camera.pitch = 0.8;
    view.camera.center = Eigen::Vector3d(0, 0, 0);
    view.camera.across_m = 16;
    view.layers.shadows = false;
    view.layers.grid = false;
    view.layers.headings = false;
  }
  void add(std::uint32_t type, double x, double y, Color color) {
    frame.mobile.push_back({type, {x, y, 0, 0}, color});
  }
  void draw() { picture = render::draw(scene, frame, view); }
  Pixel pixel(int column, int row) const {
    const std::size_t i = 4 * (static_cast<std::size_t>(row) * picture.width + column);
    return {picture.rgba[i], picture.rgba[i + 1], picture.rgba[i + 2]};
  }
  template <class Wanted>
  int count(Wanted&& wanted) const {
    int n = 0;
    for (int row = 0; row < picture.height; ++row)
      for (int column = 0; column < picture.width; ++column) n += wanted(pixel(column, row));
    return n;
  }
  /// Pixels that differ from another picture of this size.
  int differing(const Picture& other) const {
    int n = 0;
    for (std::size_t i = 0; i < picture.rgba.size(); i += 4)
      n += !std::equal(&picture.rgba[i], &picture.rgba[i] + 4, &other.rgba[i]);
    return n;
  }
};

TEST(DrawSolid, TopsHaveTheirColourAndSidesAreDarker) {
  Yard yard;
  yard.add(0, 0, 0, k_blue);
  yard.draw();
  // 40 pixels a metre at the middle; the top's far edge lies above it, the front side below.
  EXPECT_EQ(yard.pixel(320, 215), k_blue_pixel);
  const Pixel front = yard.pixel(320, 250);
  EXPECT_TRUE(is_blue(front));
  EXPECT_LT(front[2], 170);
  EXPECT_EQ(yard.pixel(320, 320), k_paper);
  EXPECT_EQ(yard.pixel(100, 100), k_paper);
  EXPECT_GT(yard.count(is_blue), 1500);
}

TEST(DrawSolid, FacesThatAreTurnedDifferentlyAreLitDifferently) {
  Yard yard;
  yard.view.camera.yaw = 0.7;  // an edge looks at the viewer
  yard.add(0, 0, 0, k_blue);
  yard.draw();
  const Pixel left = yard.pixel(308, 240);
  const Pixel right = yard.pixel(332, 240);
  EXPECT_TRUE(is_blue(left));
  EXPECT_TRUE(is_blue(right));
  EXPECT_GT(std::abs(left[2] - right[2]), 15);
}

TEST(DrawSolid, TheNearerHidesTheFarther) {
  Yard yard;
  yard.add(0, 0, 2, k_blue);
  yard.draw();
  const int alone = yard.count(is_blue);
  ASSERT_GT(alone, 1000);
  yard.add(1, 0, 0, k_green);  // tall, and in front of it
  yard.draw();
  EXPECT_LT(yard.count(is_blue), alone / 3);
  yard.frame.mobile.back().pose_world_body.y = 4;  // behind it
  yard.draw();
  EXPECT_NEAR(yard.count(is_blue), alone, 80);  // all but the blending at its rim
  std::swap(yard.frame.mobile[0], yard.frame.mobile[1]);
  yard.draw();
  EXPECT_NEAR(yard.count(is_blue), alone, 80);  // in whatever order
}

TEST(DrawSolid, WallsHideRobotsToo) {
  Yard yard;
  yard.add(0, 0, 2, k_blue);
  yard.draw();
  const int alone = yard.count(is_blue);
  yard.scene.types.push_back(
      {{FrameShape{Solid{{rectangle(-4, -0.2, 4, 0.2)}, {0, 5}}, std::nullopt}}, false, 4.1});
  yard.scene.fixed = {{2, {}, k_green}};
  yard.draw();
  EXPECT_EQ(yard.count(is_blue), 0);
  EXPECT_GT(alone, 1000);
}

TEST(DrawSolid, HollowAndConcaveSolidsShowTheFloor) {
  Yard yard;
  yard.view.camera.pitch = 0.2;  // nearly from above
  yard.scene.types.push_back(
      {{FrameShape{Solid{{rectangle(-3, -3, 3, 3), rectangle(-2, -2, 2, 2)}, {0, 0.2}}, std::nullopt}},
       false,
       4.3});
  yard.scene.fixed = {{2, {}, k_blue}};
  yard.draw();
  EXPECT_EQ(yard.pixel(320, 240), k_paper);
  EXPECT_EQ(yard.pixel(320 + 100, 240), k_blue_pixel);
  EXPECT_EQ(yard.pixel(320 - 100, 240), k_blue_pixel);
  EXPECT_EQ(yard.pixel(320 + 150, 240), k_paper);
}

TEST(DrawSolid, EdgesAreDarkAndRedWhenStalled) {
  Yard yard;
  const auto is_red = [](const Pixel& p) { return p[0] > 150 && p[1] < 90 && p[2] < 110; };
  yard.add(0, 0, 0, k_blue);
  yard.draw();
  EXPECT_EQ(yard.count(is_red), 0);
  EXPECT_GT(yard.count([](const Pixel& p) { return is_blue(p) && p[2] < 150 && p[2] > 110; }), 40);
  yard.frame.mobile[0].stalled = true;
  yard.draw();
  EXPECT_GT(yard.count(is_red), 40);
  yard.view.layers.stalls = false;
  yard.draw();
  EXPECT_EQ(yard.count(is_red), 0);
}

TEST(DrawSolid, ShapesOfAColourOfTheirOwnAreOutlinedInRedToo) {
  Yard yard;
  yard.scene.types[0].shapes[0].color = Color{0, 1, 0, 1};
  yard.add(0, 0, 0, k_blue);
  const auto red = [&] {
    yard.draw();
    return yard.count([](const Pixel& p) { return p[0] > 150 && p[1] < 90 && p[2] < 110; });
  };
  EXPECT_EQ(red(), 0);
  yard.frame.mobile[0].stalled = true;
  EXPECT_GT(red(), 40);
}

TEST(DrawSolid, ShadowsFallToTheRightAndOnlyOnTheFloor) {
  Yard yard;
  yard.add(0, 0, 0, k_blue);
  yard.draw();
  const Picture without = yard.picture;
  const int blue = yard.count(is_blue);
  yard.view.layers.shadows = true;
  yard.draw();
  EXPECT_GT(yard.differing(without), 100);
  EXPECT_NEAR(yard.count(is_blue), blue, 60);
  EXPECT_EQ(yard.pixel(320, 215), k_blue_pixel);
  const auto is_shadow = [](const Pixel& p) { return p == Pixel{226, 220, 207}; };
  int left = 0;
  int right = 0;
  for (int row = 0; row < 480; ++row)
    for (int column = 0; column < 640; ++column)
      (column < 320 ? left : right) += is_shadow(yard.pixel(column, row));
  EXPECT_GT(right, 200);
  EXPECT_GT(right, 2 * left);
}

TEST(DrawSolid, FarRobotsStayVisible) {
  Yard yard;
  yard.view.camera.center.reset();
  yard.view.camera.across_m.reset();
  yard.scene.bounds = {{-5000, -5000}, {5000, 5000}};
  yard.add(0, 0, 0, k_blue);
  yard.add(0, 2000, 3000, k_blue);
  yard.draw();
  EXPECT_GE(yard.count(is_blue), 12);
  EXPECT_LE(yard.count(is_blue), 60);
}

TEST(DrawSolid, EverythingIsInThePictureByItself) {
  for (const double yaw : {0.0, 0.8, -2.0}) {
    for (const bool perspective : {false, true}) {
      Yard yard;
      yard.view.camera.center.reset();
      yard.view.camera.across_m.reset();
      yard.view.camera.yaw = yaw;
      yard.view.camera.perspective = perspective;
      for (const double x : {-7.4, 7.4})
        for (const double y : {-7.4, 7.4}) yard.add(0, x, y, k_blue);
      yard.draw();
      int rim = 0;
      for (int column = 0; column < 640; ++column)
        rim += is_blue(yard.pixel(column, 0)) + is_blue(yard.pixel(column, 479));
      for (int row = 0; row < 480; ++row) rim += is_blue(yard.pixel(0, row)) + is_blue(yard.pixel(639, row));
      EXPECT_EQ(rim, 0) << yaw;
      EXPECT_GT(yard.count(is_blue), 800) << yaw;
    }
  }
}

TEST(DrawSolid, ACameraMayStandAmongTheRobots) {
  Yard yard;
  yard.view.camera.center.reset();
  yard.view.camera.across_m.reset();
  yard.view.camera.eye = Eigen::Vector3d(0, -2, 1.2);
  yard.view.camera.pitch = 1.4;
  yard.view.layers.grid = true;
  yard.add(0, 0, 3, k_blue);    // ahead
  yard.add(0, 0, -6, k_green);  // behind
  yard.draw();
  EXPECT_GT(yard.count(is_blue), 3000);
  EXPECT_EQ(yard.count(is_green), 0);
}

TEST(DrawSolid, TheGridIsAlsoAroundRobotsThatHaveLeftTheBounds) {
  Yard yard;
  const auto lines_at = [&](double x, double y) {  // pixels of grid lines in a picture without bodies
    yard.view.camera.center = Eigen::Vector3d(x, y, 0);
    yard.view.layers.grid = false;
    yard.draw();
    const Picture without = yard.picture;
    yard.view.layers.grid = true;
    yard.draw();
    return yard.differing(without);
  };
  yard.view.layers.scale = false;
  const int inside = lines_at(0, 0);
  for (const double away : {40.0, 1000.0, -1e5}) {
    EXPECT_GT(lines_at(away, 0), inside / 2) << away;
    EXPECT_GT(lines_at(0, away), inside / 2) << away;
  }
  yard.scene.bounds = {};
  EXPECT_GT(lines_at(3, 0), inside / 2);
}

TEST(DrawSolid, CloseViewsOfLargeWorldsShowTheirTargets) {
  for (const double half : {8.0, 5000.0}) {
    Yard yard;
    yard.scene.types[0] = box_type(0.04, 0.06, true);
    yard.scene.bounds = {{-half, -half}, {half, half}};
    yard.view.camera.across_m = 0.5;
    yard.add(0, 0, 0, k_blue);
    yard.draw();
    EXPECT_GT(yard.count(is_blue), 5000) << half;
  }
}

TEST(DrawSolid, LayersChangeTheirPixelsAndNoOthers) {
  Yard yard;
  yard.add(0, 0, 0, k_blue);
  yard.draw();
  const Picture before = yard.picture;
  const auto changes = [&](bool Layers::*layer) {
    Yard other = yard;
    other.view.layers.*layer = !(other.view.layers.*layer);
    other.draw();
    return other.differing(before);
  };
  EXPECT_GT(changes(&Layers::grid), 1000);
  EXPECT_GT(changes(&Layers::headings), 20);
  EXPECT_LT(changes(&Layers::headings), 400);
  EXPECT_GT(changes(&Layers::clock), 50);
  EXPECT_GT(changes(&Layers::density), 500);
  EXPECT_EQ(changes(&Layers::scans), 0);  // there are none
  EXPECT_EQ(changes(&Layers::names), 0);
  EXPECT_EQ(changes(&Layers::tiles), 0);
}

TEST(DrawSolid, ScansAreFilledAndTransparentFromBothViews) {
  for (const bool perspective : {true, false}) {
    Yard yard;
    yard.view.camera.perspective = perspective;
    yard.view.camera.pitch = perspective ? 0.5 : 0;
    yard.scene.rangers = {{0, 3, {{{0, 0, 0.5, 0}, 5, 1.0, 0, 3}}}};
    yard.add(0, -3, 0, k_green);
    yard.frame.scans = {{0, 0, 0}};
    yard.frame.ranges = {4, 4, 4};
    yard.draw();
    const Picture without = yard.picture;
    yard.view.layers.scans = true;
    yard.draw();
    const Pixel inside = yard.pixel(330, perspective ? 225 : 240);  // ahead of it, 3 m
    EXPECT_TRUE(is_green(inside) || inside[1] > inside[0]) << perspective;
    EXPECT_NE(inside, k_paper);
    EXPECT_GT(inside[1], 200);  // the paper shines through
    EXPECT_GT(yard.differing(without), 4000);
    EXPECT_EQ(yard.pixel(100, 240), k_paper);  // behind it
  }
}

TEST(DrawSolid, ScansAboveAllBodiesAreDrawn) {
  struct Case {
    bool perspective;
    double pitch, yaw;
    double y, z;  // of the ranger, m: near the middle of the picture
  };
  for (const Case& each : {Case{false, 0, 0, 0, 9}, Case{false, 0, 0.5, 0, 9},
                           Case{false, 0.8, 0, -9.3, 9.06}, Case{true, 0.8, 0, -9.3, 9.06}}) {
    Yard yard;
    yard.view.camera.perspective = each.perspective;
    yard.view.camera.pitch = each.pitch;
    yard.view.camera.yaw = each.yaw;
    yard.scene.rangers = {{0, 3, {{{0, 0, each.z, 0}, 5, 1.0, 0, 3}}}};
    yard.add(0, 0, each.y, k_green);
    yard.frame.scans = {{0, 0, 0}};
    yard.frame.ranges = {4, 4, 4};
    yard.draw();
    const Picture without = yard.picture;
    yard.view.layers.scans = true;
    yard.draw();
    EXPECT_GT(yard.differing(without), 4000) << each.perspective << ", " << each.pitch << ", " << each.yaw;
  }
}

TEST(DrawSolid, ScansAreDrawnOnLargeMaps) {
  for (const double yaw : {0.0, 0.5}) {
    Yard yard;
    yard.scene.bounds = {{-8000, -6000}, {8000, 6000}};
    yard.view.camera.perspective = false;
    yard.view.camera.pitch = 0;
    yard.view.camera.yaw = yaw;
    yard.view.camera.across_m = 16000;
    yard.scene.rangers = {{0, 3, {{{0, 0, 0.5, 0}, 5000, 1.0, 0, 3}}}};
    yard.add(0, -3000, 0, k_green);
    yard.frame.scans = {{0, 0, 0}};
    yard.frame.ranges = {4000, 4000, 4000};
    yard.draw();
    const Picture without = yard.picture;
    yard.view.layers.scans = true;
    yard.draw();
    EXPECT_GT(yard.differing(without), 4000) << yaw;
  }
}

TEST(DrawSolid, TallBodiesHighUpAreNotCutOff) {
  Yard yard;
  yard.view.camera.perspective = false;
  yard.scene.types.push_back(box_type(0.5, 8, true));
  yard.frame.mobile = {{2, {0, -10, 8, 0}, k_blue}};
  yard.draw();
  // The top is at z = 16: 16 sin(pitch) - 10 cos(pitch) = 4.51 m above the middle, at 40 pixels per metre.
  EXPECT_EQ(yard.pixel(320, 60), k_blue_pixel);
}

TEST(DrawSolid, ScansOfWhatJointsHaveMovedBeginThere) {
  Yard yard;
  yard.view.camera.pitch = 0.2;
  yard.scene.rangers = {{0, 2, {{{0, 0, 0.5, 0}, 3, 0.6, 0, 2}}}};
  yard.add(0, 0, 0, k_green);
  yard.frame.scans = {{0, 0, 0, {}}};
  yard.frame.ranges = {3, 3};
  yard.view.layers.scans = true;
  yard.draw();
  const auto tinted = [&](int column, int row) { return yard.pixel(column, row) != k_paper; };
  EXPECT_TRUE(tinted(320 + 80, 240));   // 2 m ahead
  EXPECT_FALSE(tinted(320, 240 - 80));  // 2 m to the left
  yard.frame.scans[0].moved = {0, 0, 0, k_pi / 2};
  yard.draw();
  EXPECT_FALSE(tinted(320 + 80, 240));
  EXPECT_TRUE(tinted(320, 240 - 80));
}

TEST(DrawSolid, WhatDevicesSeeAndHoldIsDrawnWhereItIs) {
  using Kind = engine::FrameTie::Kind;
  const auto is_red = [](const Pixel& p) { return p[0] > 150 && p[1] < 110 && p[2] < 110; };
  const auto is_dark = [](const Pixel& p) { return p[0] < 110 && p[1] < 110 && p[2] < 110; };
  for (const bool perspective : {true, false}) {
    Yard yard;
    yard.view.camera.perspective = perspective;
    yard.view.camera.pitch = perspective ? 0.3 : 0;
    yard.view.layers.scale = false;
    yard.view.layers.clock = false;
    yard.add(0, -3, 0, k_blue);
    yard.frame.blobs = {{0, {-3, 0, 0.5}, {2, -1, 0.5}, {2, 1, 0.5}, {0, 0.6F, 0, 1}}};
    yard.frame.grips = {{Kind::broken_beam, {-1, 1, 0.1}, {1, 1, 0.1}},
                        {Kind::holds, {-3, 0, 1}, {-3, 4, 1}}};
    yard.frame.links = {{Kind::carries, {-3, 0, 1}, {3, -4, 0}}};
    yard.draw();
    const Picture plain = yard.picture;
    const auto with = [&](bool Layers::*layer) {
      Yard other = yard;
      other.view.layers.*layer = true;
      other.draw();
      EXPECT_GT(other.differing(plain), 40) << perspective;
      return other;
    };
    EXPECT_GT(with(&Layers::blobs).count(is_green), 50) << perspective;
    const Yard grips = with(&Layers::grips);
    EXPECT_GT(grips.count(is_red), 40) << perspective;
    EXPECT_GT(grips.count(is_dark), 60) << perspective;
    const Yard links = with(&Layers::links);
    EXPECT_GT(links.count(is_dark), 100) << perspective;
    EXPECT_EQ(links.count(is_red), yard.count(is_red)) << perspective;
  }
}

TEST(DrawSolid, CoveredSquaresArePalerTheLongerAgo) {
  Yard yard;
  yard.view.camera.pitch = 0.1;
  yard.frame.covered = {{-4, 0, 0.0F}, {3, 0, 1.0F}};
  yard.frame.covered_m = 1;
  yard.draw();
  EXPECT_EQ(yard.pixel(320 + 140, 225), k_paper);
  yard.view.layers.coverage = true;
  yard.draw();
  const Pixel old = yard.pixel(320 - 140, 225);
  const Pixel fresh = yard.pixel(320 + 140, 225);
  EXPECT_LT(old[0], k_paper[0] - 10);
  EXPECT_LT(fresh[0], old[0] - 10);
  EXPECT_EQ(yard.pixel(320, 225), k_paper);
}

TEST(DrawSolid, TheClockTellsTheSpeedWhereThatIsAskedFor) {
  Yard yard;
  yard.frame.times_real_time = 12.5;
  yard.draw();
  const Picture before = yard.picture;
  yard.view.layers.speed = true;
  yard.draw();
  EXPECT_GT(yard.differing(before), 60);
  yard.frame.times_real_time = 0;  // unknown
  yard.draw();
  EXPECT_EQ(yard.differing(before), 0);
}

TEST(DrawSolid, BodiesAreColouredByTheirValues) {
  Yard yard;
  yard.add(0, -2, 0, k_blue);
  yard.add(0, 2, 0, k_blue);
  yard.frame.values = {0, 1};
  yard.frame.value_name = "velocity.x (m/s)";
  yard.draw();
  EXPECT_EQ(yard.pixel(320 - 80, 215), (Pixel{68, 1, 84}));
  EXPECT_EQ(yard.pixel(320 + 80, 215), (Pixel{253, 231, 37}));
  yard.view.values = std::pair(0.0, 2.0);
  yard.draw();
  EXPECT_EQ(yard.pixel(320 + 80, 215), (Pixel{33, 144, 141}));
  EXPECT_NE(yard.pixel(40, 37), k_paper);  // the legend
}

TEST(DrawSolid, NamesAndChargesStandAtTheirBodies) {
  for (const bool perspective : {true, false}) {
    Yard yard;
    yard.view.camera.perspective = perspective;
    yard.view.camera.pitch = perspective ? 0.8 : 0;
    yard.add(0, -3, 0, k_blue);
    yard.frame.names = {"west"};
    yard.frame.charges = {0.5};
    yard.draw();
    const Picture plain = yard.picture;
    for (bool Layers::*layer : {&Layers::names, &Layers::energy}) {
      Yard other = yard;
      other.view.layers.*layer = true;
      other.draw();
      int near = 0;
      int all = other.differing(plain);
      for (int row = 140; row < 300; ++row) {
        for (int column = 150; column < 320; ++column) {
          const std::size_t i = 4 * (static_cast<std::size_t>(row) * 640 + column);
          near += !std::equal(&plain.rgba[i], &plain.rgba[i] + 4, &other.picture.rgba[i]);
        }
      }
      EXPECT_GT(near, 60) << perspective;
      EXPECT_EQ(near, all) << perspective;
    }
  }
}

TEST(DrawSolid, ManyPicturesOfOnePainterAreThoseOfOneEach) {
  Yard yard;
  yard.add(0, 1, 2, k_blue);
  Painter painter(yard.scene);
  yard.draw();
  for (int i = 0; i < 2; ++i) EXPECT_EQ(painter.draw(yard.frame, yard.view).rgba, yard.picture.rgba);
  yard.view.camera.perspective = false;
  yard.view.camera.pitch = 0;
  yard.view.width = 200;
  yard.draw();
  EXPECT_EQ(painter.draw(yard.frame, yard.view).rgba, yard.picture.rgba);
  std::thread([&] { EXPECT_EQ(painter.draw(yard.frame, yard.view).rgba, yard.picture.rgba); }).join();
}

TEST(DrawSolid, TenThousandRobots) {
  Yard yard;
  yard.scene.types[0] = box_type(0.1, 0.1, true);
  yard.scene.bounds = {{-50, -50}, {50, 50}};
  yard.view.camera.center.reset();
  yard.view.camera.across_m.reset();
  for (int i = 0; i < 10000; ++i) yard.add(0, -49.5 + i % 100, -49.5 + i / 100, k_blue);
  yard.draw();
  EXPECT_GT(yard.count(is_blue), 50000);
}

}  // namespace
}  // namespace troupe::render::draw_solid_test
