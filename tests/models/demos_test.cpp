#include "models/controllers/rasterize.hpp"

#include "tests/support/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace troupe::models {
namespace {

using test::SceneBuilder;

const RasterizeMemory& raster_of(const engine::World& world, BodyId body) {
  const Row row = world.row(body);
  const engine::BodyType::Controller& controller = world.type(row).controllers.front();
  return world.tables()[*controller.table].as<RasterizeMemory>(world.slot(row));
}

TEST(Rasterize, MarksTheCellsThatOutlinesGoThrough) {
  SceneBuilder scene;
  // 4 x 2 m: cells of 0.1 m. A frame along the border, and a box whose outline goes through 5 x 5 cells.
  const TypeId type =
      scene.type("map", {test::box(4, 2), Solid{{test::rectangle(0.05, 0.05, 0.45, 0.45)}, {0, 1}}});
  scene[type].controllers = {test::controller("rasterize")};
  const BodyId body = scene.body("map", type, {7, 3, 0, 1});
  engine::World world = scene.world();
  world.step();
  const auto& cells = raster_of(world, body).cells;
  const auto at = [&](std::uint32_t x, std::uint32_t y) { return cells[y * k_raster_columns + x]; };
  for (std::uint32_t x = 0; x < k_raster_columns; ++x) EXPECT_EQ(at(x, 0) + at(x, k_raster_rows - 1), 2) << x;
  for (std::uint32_t y = 0; y < k_raster_rows; ++y) EXPECT_EQ(at(0, y) + at(k_raster_columns - 1, y), 2) << y;
  const int border = 2 * 40 + 2 * 18;
  const int box = 5 * 5 - 3 * 3;
  EXPECT_EQ(std::accumulate(cells.begin(), cells.end(), 0), border + box);
  EXPECT_EQ(at(20, 10), 1);
  EXPECT_EQ(at(22, 12), 0);
}

TEST(Dynamic, AddsChildrenAboutItsModel) {
  const engine::ControllerKind kind = *test::registry().controller("dynamic");
  engine::TypeSpec type;
  type.parts.push_back({.kind = "model", .size = {0.4, 0.4, 1}, .solids = {test::box(0.4, 0.4)}});
  kind.furnish(kind.params.defaults(), 1, test::registry(), type, 0);
  ASSERT_EQ(type.parts.size(), 101);
  EXPECT_EQ(type.parts[1].name, "dynamic:0");
  bool differ = false;
  for (std::size_t p = 1; p < type.parts.size(); ++p) {
    const engine::PartSpec& child = type.parts[p];
    EXPECT_LE(std::abs(child.pose_body_part.x), 1);
    EXPECT_LE(std::abs(child.pose_body_part.y), 1);
    EXPECT_EQ(child.parent, 0);
    EXPECT_EQ(child.solids.at(0).z, (ZInterval{1, 1.1}));  // stands on it
    differ = differ || child.pose_body_part.x != type.parts[1].pose_body_part.x;
  }
  EXPECT_TRUE(differ);
  engine::TypeSpec other;
  other.parts.push_back(type.parts.front());
  kind.furnish(kind.params.defaults(), 1, test::registry(), other, 0);
  EXPECT_EQ(other.parts.back().pose_body_part, type.parts.back().pose_body_part);
  other.parts.resize(1);
  kind.furnish(kind.params.defaults(), 2, test::registry(), other, 0);
  EXPECT_NE(other.parts.back().pose_body_part, type.parts.back().pose_body_part);
}

TEST(LaserNoise, GivesTheFirstTransducerOfItsRangerAnErrorOfFivePerCent) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {test::box(0.4, 0.4)});
  scene[type].devices = {
      test::ranger("eye", {{.range_max = 8, .samples = 1}, {.range_max = 8, .samples = 1}})};
  scene[type].controllers = {test::controller("lasernoise")};
  const engine::ControllerKind& kind = *test::registry().controller("lasernoise");
  kind.furnish(kind.params.defaults(), 1, test::registry(), scene[type], 0);
  scene.body("r", type);
  scene.wall(4, -1, 4.2, 1);
  engine::World world = scene.world();
  const Row row = world.row(BodyId(1));
  constexpr int k_ticks = 2000;
  double sum = 0;
  double squares = 0;
  for (int t = 0; t < k_ticks; ++t) {
    world.step();
    const auto ranges = world.percepts(world.type(row).devices.front()).cell<float>(world.slot(row), 0);
    EXPECT_NEAR(ranges[1], 4, 1e-6);
    sum += ranges[0];
    squares += ranges[0] * ranges[0];
  }
  const double mean = sum / k_ticks;
  EXPECT_NEAR(mean, 4, 0.02);  // four standard errors
  EXPECT_NEAR(std::sqrt(squares / k_ticks - mean * mean), 0.2, 0.015);
}

}  // namespace
}  // namespace troupe::models
