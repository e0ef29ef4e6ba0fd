#include "models/controllers/rasterize.hpp"

#include "tests/support/scene.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace troupe::models::rasterize_test {
namespace {

using test::SceneBuilder;

const RasterizeMemory& raster_of(const engine::World& world, BodyId body) {
  const Row row = world.view().row(body);
  const engine::BodyType::Controller& controller = world.view().type(row).controllers.front();
  return world.tables()[*controller.table].as<RasterizeMemory>(world.view().slot(row));
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

TEST(Rasterize, IsInTheFrameOfItsPart) {
  const Ring triangle{{0, 0}, {4, 0}, {0, 0.5}};
  const Pose pose_body_part{1, 2, 0, k_pi / 2};
  SceneBuilder scene;
  const TypeId whole = scene.type("whole", {Solid{{triangle}, {0, 1}}});
  scene[whole].controllers = {test::controller("rasterize")};
  const TypeId carrier = scene.type("carrier", {test::box(0.1, 0.1)});
  scene[carrier].parts.push_back({.name = "part", .pose_body_part = pose_body_part});
  Ring turned;
  for (const Vec2& vertex : triangle) turned.push_back(Transform(pose_body_part) * vertex);
  scene[carrier].parts[1].solids = {Solid{{turned}, {0, 1}}};  // solids of parts are in the frame of the body
  scene[carrier].controllers = {test::controller("rasterize")};
  scene[carrier].controllers[0].part = 1;
  const BodyId a = scene.body("a", whole);
  const BodyId b = scene.body("b", carrier, {9, 9, 0, 0});
  engine::World world = scene.world();
  world.step();
  EXPECT_EQ(raster_of(world, b).cells, raster_of(world, a).cells);
}

}  // namespace
}  // namespace troupe::models::rasterize_test
