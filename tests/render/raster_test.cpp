#include "render/raster.hpp"

#include "base/hash.hpp"
#include "base/random.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::render {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Corners = std::array<PixelPoint, 3>;

constexpr Rgba k_sand = {250, 240, 230, 255};
constexpr Rgba k_wine = {200, 10, 20, 255};
constexpr Rgba k_sea = {10, 20, 200, 255};

Rgba pixel(const Bytes& rgba, int width, int x, int y) {
  const std::size_t i =
      4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  return {rgba[i], rgba[i + 1], rgba[i + 2], rgba[i + 3]};
}

/// How many of a pixel's four samples lie in a triangle, by the signs of areas in floating point. Corners
/// must lie on 1/256 pixel; a sample on a side counts as none.
int samples_in(const Corners& c, int x, int y) {
  constexpr std::array<std::array<double, 2>, 4> k_samples = {
      {{0.375, 0.125}, {0.875, 0.375}, {0.125, 0.625}, {0.625, 0.875}}};
  int count = 0;
  for (const auto& [right, down] : k_samples) {
    const auto area = [&, px = x + right, py = y + down](int i, int k) {
      return (c[k].x - c[i].x) * (py - c[i].y) - (c[k].y - c[i].y) * (px - c[i].x);
    };
    const double a = area(0, 1);
    const double b = area(1, 2);
    const double d = area(2, 0);
    count += (a > 0 && b > 0 && d > 0) || (a < 0 && b < 0 && d < 0);
  }
  return count;
}

double on_grid(double x) { return std::round(x * 256) / 256; }

TEST(Raster, CoversTheSamplesInsideATriangle) {
  constexpr int k_width = 150;
  constexpr int k_height = 70;
  Random random(1, 2, 3, 4);
  Raster raster;
  int partly = 0;
  for (int round = 0; round < 300; ++round) {
    const double reach = round % 3 == 0   ? 1000
                         : round % 3 == 1 ? 60
                                          : 3;  // from much larger than a tile to a pixel
    const double x = random.uniform(0, k_width);
    const double y = random.uniform(0, k_height);
    Corners corners;
    for (PixelPoint& corner : corners)
      corner = {on_grid(x + random.uniform(-reach, reach)) + 1.0 / 512,
                on_grid(y + random.uniform(-reach, reach)), 0};
    for (PixelPoint& corner : corners) corner.x = on_grid(corner.x);
    raster.begin(k_width, k_height, {0, 0, 0, 255});
    raster.add_triangle(corners, {200, 100, 0, 255}, DepthRule::none);
    const Bytes rgba = raster.finish();
    for (int row = 0; row < k_height; ++row)
      for (int column = 0; column < k_width; ++column) {
        const int count = samples_in(corners, column, row);
        partly += count > 0 && count < 4;
        ASSERT_EQ(pixel(rgba, k_width, column, row)[0], (200 * count + 2) / 4)
            << "round " << round << ", pixel " << column << ", " << row;
      }
  }
  EXPECT_GT(partly, 1000);
}

TEST(Raster, TrianglesThatShareASideCoverEachSampleOnce) {
  Random random(5, 6, 7, 8);
  Raster raster;
  for (int round = 0; round < 50; ++round) {
    // A fan about a point, whose corners lie on samples and on pixels' corners as often as anywhere.
    const auto near = [&] { return std::round(random.uniform(20, 44) * 8) / 8; };
    const PixelPoint middle{near(), near(), 0};
    const std::array<PixelPoint, 4> around = {{{-2, -2, 0}, {70, -2, 0}, {70, 70, 0}, {-2, 70, 0}}};
    raster.begin(64, 64, {0, 0, 0, 255});
    for (std::size_t i = 0; i < 4; ++i)
      raster.add_triangle({middle, around[i], around[(i + 1) % 4]}, {255, 255, 255, 128}, DepthRule::none);
    const Bytes rgba = raster.finish();
    for (std::size_t i = 0; i < rgba.size(); i += 4) ASSERT_EQ(rgba[i], 128) << "round " << round;
  }
}

TEST(Raster, TheNearerCoversTheFartherUntilDepthsAreCleared) {
  const auto square = [](double z) -> Corners { return {{{-10, -10, z}, {90, -10, z}, {-10, 90, z}}}; };
  Raster raster;
  const auto drawn = [&](double second, DepthRule rule, bool clears) {
    raster.begin(40, 40, k_sand);
    raster.add_triangle(square(0.5), k_wine, DepthRule::test_and_write);
    if (clears) raster.clear_depth();
    raster.add_triangle(square(second), k_sea, rule);
    return pixel(raster.finish(), 40, 5, 5);
  };
  EXPECT_EQ(drawn(0.4, DepthRule::test_and_write, false), k_sea);
  EXPECT_EQ(drawn(0.5, DepthRule::test_and_write, false), k_sea);  // of equals the later
  EXPECT_EQ(drawn(0.6, DepthRule::test_and_write, false), k_wine);
  EXPECT_EQ(drawn(0.6, DepthRule::test, false), k_wine);
  EXPECT_EQ(drawn(0.6, DepthRule::none, false), k_sea);
  EXPECT_EQ(drawn(0.6, DepthRule::test_and_write, true), k_sea);
}

TEST(Raster, SlopesMeetWhereTheyCross) {
  Raster raster;
  raster.begin(100, 10, k_sand);
  raster.add_triangle({{{0, -50, 0}, {100, -50, 1}, {50, 100, 0.5}}}, k_wine, DepthRule::test_and_write);
  raster.add_triangle({{{0, -50, 1}, {100, -50, 0}, {50, 100, 0.5}}}, k_sea, DepthRule::test_and_write);
  const Bytes rgba = raster.finish();
  EXPECT_EQ(pixel(rgba, 100, 45, 5), k_wine);
  EXPECT_EQ(pixel(rgba, 100, 55, 5), k_sea);
}

TEST(Raster, ATransparentGroundKeepsColoursAsTheyAre) {
  Raster raster;
  raster.begin(40, 8, {0, 0, 0, 0});
  raster.add_triangle({{{0, -50, 0}, {0, 100, 0}, {20.5, 25, 0}}}, k_wine, DepthRule::none);
  raster.add_square({30, 4, 0}, 6, {10, 200, 30, 64}, DepthRule::none);
  const Bytes rgba = raster.finish();
  EXPECT_EQ(pixel(rgba, 40, 2, 4), k_wine);
  EXPECT_EQ(pixel(rgba, 40, 25, 4)[3], 0);
  const Rgba seen_through = pixel(rgba, 40, 30, 4);
  EXPECT_EQ(seen_through[3], 64);
  EXPECT_NEAR(seen_through[1], 200, 3);  // eight bits of 64 / 255 parts
  int partly = 0;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 24; ++x) {
      const Rgba edge = pixel(rgba, 40, x, y);
      partly += edge[3] > 0 && edge[3] < 255;
      if (edge[3] > 0) {
        EXPECT_NEAR(edge[0], 200, 3);
      }
    }
  EXPECT_GT(partly, 0);
}

/// A hundred shapes of all sorts; some of them differ from picture to picture.
Bytes crowd(Raster& raster, int picture) {
  Random random(9, 10, 11, 12);
  raster.begin(333, 201, k_sand);
  for (int i = 0; i < 100; ++i) {
    const double moved = i % 10 == 0 ? 3.7 * picture : 0;
    const PixelPoint middle{random.uniform(-20, 350) + moved, random.uniform(-20, 220), random.uniform()};
    const auto byte = [&] { return static_cast<std::uint8_t>(random.uniform(0, 255)); };
    const Rgba color{byte(), byte(), byte(), static_cast<std::uint8_t>(i % 3 == 0 ? 90 : 255)};
    const auto rule = static_cast<DepthRule>(i % 4 == 0 ? 2 : i % 7 == 0 ? 1 : 0);
    if (i == 60) raster.clear_depth();
    if (i % 5 == 0) {
      raster.add_square(middle, random.uniform(1, 40), color, rule);
      continue;
    }
    Corners corners;
    for (PixelPoint& corner : corners)
      corner = {middle.x + random.uniform(-60, 60), middle.y + random.uniform(-60, 60), random.uniform()};
    raster.add_triangle(corners, color, rule);
  }
  return raster.finish();
}

TEST(Raster, WhatIsTakenOverFromThePictureBeforeIsAsIfDrawn) {
  Raster kept;
  for (const int picture : {0, 1, 2, 2, 0}) {
    Raster fresh;
    EXPECT_EQ(crowd(kept, picture), crowd(fresh, picture)) << picture;
  }
  kept.begin(333, 201, {0, 0, 0, 255});  // another ground
  EXPECT_EQ(pixel(kept.finish(), 333, 100, 100), (Rgba{0, 0, 0, 255}));
}

/// Changes only with the rules of drawing: the same bytes on every processor and from every compiler.
TEST(Raster, ThePictureOfACrowdHasItsHash) {
  Raster raster;
  const Bytes rgba = crowd(raster, 0);
  EXPECT_EQ(hex(hash_text({reinterpret_cast<const char*>(rgba.data()), rgba.size()})), "259fb766199c576b");
}

TEST(Raster, FarCornersAndShapesWithoutAnAreaAreHarmless) {
  Raster raster;
  raster.begin(64, 64, k_sand);
  const double far = Raster::k_guard;
  raster.add_triangle({{{-far, -far, 0}, {far, -far, 0}, {0, far, 0}}}, k_wine, DepthRule::test_and_write);
  raster.add_triangle({{{10, 10, 0}, {20, 20, 0}, {30, 30, 0}}}, k_sea, DepthRule::none);
  raster.add_triangle({{{10, 10, 0}, {10, 10, 0}, {10, 10, 0}}}, k_sea, DepthRule::test_and_write);
  raster.add_triangle({{{10, 10, 0}, {40, 10.001, 1}, {40, 10, 0.1}}}, k_sea, DepthRule::test_and_write);
  const Bytes rgba = raster.finish();
  EXPECT_EQ(pixel(rgba, 64, 5, 5), k_wine);
  EXPECT_EQ(pixel(rgba, 64, 20, 20), k_wine);
}

}  // namespace
}  // namespace troupe::render
