#include "render/map_furniture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace troupe::render::map_furniture_test {
namespace {

TEST(RoundLength, IsTheLargestThatFits) {
  EXPECT_DOUBLE_EQ(RoundLength::at_most(1.5).metres, 1);
  EXPECT_DOUBLE_EQ(RoundLength::at_most(4.9).metres, 2);
  EXPECT_DOUBLE_EQ(RoundLength::at_most(73).metres, 50);
  EXPECT_DOUBLE_EQ(RoundLength::at_most(0.032).metres, 0.02);
}

TEST(RoundLength, NamesItselfWithoutExponents) {
  EXPECT_EQ(RoundLength::at_most(73).text(), "50 m");
  EXPECT_EQ(RoundLength::at_most(1.7).text(), "1 m");
  EXPECT_EQ(RoundLength::at_most(0.27).text(), "0.2 m");
  EXPECT_EQ(RoundLength::at_most(0.06).text(), "0.05 m");
  EXPECT_EQ(RoundLength::at_most(0.0071).text(), "5 mm");
  EXPECT_EQ(RoundLength::at_most(0.00025).text(), "0.2 mm");
  EXPECT_EQ(RoundLength::at_most(2100).text(), "2 km");
  EXPECT_EQ(RoundLength::at_most(1.2e8).text(), "100000 km");
}

Framing framing_of(int width, int height) {
  Framing framing;
  framing.width = width;
  framing.height = height;
  framing.pixels_per_metre = 100;
  return framing;
}

TEST(FloorGrid, LiesOnWholePixelsAtRoundWorldCoordinates) {
  Framing framing = framing_of(400, 200);
  framing.center = {0.3, 0};
  // Shown: x from -1.7 to 2.3, y from -1 to 1. Lines a metre apart: four across, three along.
  const Mesh mesh = floor_grid(framing, Rgba{});
  ASSERT_EQ(mesh.size(), 7U * 6);
  EXPECT_FLOAT_EQ(mesh[0].x + 200, 70);  // x = -1
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    EXPECT_FLOAT_EQ(mesh[i].x, std::round(mesh[i].x)) << i;
    EXPECT_FLOAT_EQ(mesh[i].y, std::round(mesh[i].y)) << i;
  }
}

TEST(FloorGrid, StaysSparseAtAnyScale) {
  for (const double scale : {1e-9, 1e-4, 0.03, 1.0, 77.0, 1e5}) {
    Framing framing = framing_of(1280, 720);
    framing.pixels_per_metre = scale;
    const std::size_t lines = floor_grid(framing, Rgba{}).size() / 6;
    EXPECT_GE(lines, 12U) << scale;
    EXPECT_LE(lines, (1280 + 720) / 48 + 2U) << scale;
  }
}

Mesh furniture(const Framing& framing, const Furniture& shown) {
  Writing writing;
  add_furniture(writing, framing, shown);
  return mesh_of(writing, framing.stroke, theme_of(Background::paper));
}

TEST(Furniture, TheClockHasNoExponents) {
  EXPECT_EQ(clock_text(12.5), "12.5 s");
  EXPECT_EQ(clock_text(12.5, 0.25), "12.5 s  0.25 x real time");
  EXPECT_EQ(clock_text(12.5, 999.6), "12.5 s  1000 x real time");
  EXPECT_EQ(clock_text(12.5, 7821.4), "12.5 s  7821 x real time");
}

TEST(Furniture, StaysInsideThePicture) {
  const Framing framing = framing_of(240, 160);
  const Mesh mesh = furniture(framing, {.right = clock_text(123456.7)});
  ASSERT_FALSE(mesh.empty());
  for (const Vertex& v : mesh) {
    EXPECT_LE(std::abs(v.x + v.offset_x), 120);
    EXPECT_LE(std::abs(v.y + v.offset_y), 80);
  }
}

TEST(Furniture, IsLeftOutOfThumbnails) {
  EXPECT_TRUE(furniture(framing_of(239, 400), {.right = "1.0 s"}).empty());
}

TEST(Furniture, ShowsWhatItIsAskedFor) {
  const Framing framing = framing_of(640, 480);
  EXPECT_TRUE(furniture(framing, {.scale = false}).empty());
  const auto reaches = [&](const Furniture& shown) {
    double left = 0;
    double right = 0;
    for (const Vertex& v : furniture(framing, shown)) {
      left = std::min<double>(left, v.x);
      right = std::max<double>(right, v.x);
    }
    return std::pair(left, right);
  };
  EXPECT_LT(reaches({.scale = false, .left = "west"}).first, -280);
  EXPECT_LT(reaches({.scale = false, .left = "west"}).second, 1);
  EXPECT_GT(reaches({.scale = false, .right = "east"}).first, -1);
  EXPECT_GT(reaches({.scale = false, .right = "east"}).second, 280);
}

}  // namespace
}  // namespace troupe::render::map_furniture_test
