#include "worldio/stage/stage_demos.hpp"

#include "tests/support/scene.hpp"
#include "worldio/load.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace troupe::worldio::stage_demos_test {
namespace {

using test::SceneBuilder;

TEST(Dynamic, AddsChildrenAboutItsModel) {
  const engine::ControllerKind kind = *test::registry().controller("dynamic");
  engine::TypeSpec type;
  type.parts.push_back({.kind = "model", .size = {0.4, 0.4, 1}, .solids = {test::box(0.4, 0.4)}});
  EXPECT_TRUE(stage_addition("dynamic")(kind.params.defaults(), 1, test::registry(), type, 0));
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
  EXPECT_TRUE(stage_addition("dynamic")(kind.params.defaults(), 1, test::registry(), other, 0));
  EXPECT_EQ(other.parts.back().pose_body_part, type.parts.back().pose_body_part);
  other.parts.resize(1);
  EXPECT_TRUE(stage_addition("dynamic")(kind.params.defaults(), 2, test::registry(), other, 0));
  EXPECT_NE(other.parts.back().pose_body_part, type.parts.back().pose_body_part);
}

TEST(LaserNoise, GivesTheFirstTransducerOfItsRangerAnErrorOfFivePerCent) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {test::box(0.4, 0.4)});
  scene[type].devices = {
      test::ranger("eye", {{.range_max = 8, .samples = 1}, {.range_max = 8, .samples = 1}})};
  scene[type].controllers = {test::controller("lasernoise")};
  const engine::ControllerKind& kind = *test::registry().controller("lasernoise");
  EXPECT_TRUE(stage_addition("lasernoise")(kind.params.defaults(), 1, test::registry(), scene[type], 0));
  scene.body("r", type);
  scene.wall(4, -1, 4.2, 1);
  engine::World world = scene.world();
  const Row row = world.view().row(BodyId(1));
  constexpr int k_ticks = 2000;
  double sum = 0;
  double squares = 0;
  for (int t = 0; t < k_ticks; ++t) {
    world.step();
    const auto ranges =
        world.tables()[world.view().type(row).devices.front().table].cell<float>(world.view().slot(row), 0);
    EXPECT_NEAR(ranges[1], 4, 1e-6);
    sum += ranges[0];
    squares += ranges[0] * ranges[0];
  }
  const double mean = sum / k_ticks;
  EXPECT_NEAR(mean, 4, 0.02);  // four standard errors
  EXPECT_NEAR(std::sqrt(squares / k_ticks - mean * mean), 0.2, 0.015);
}

TEST(LaserNoise, HasNoEffectOutsideOfARanger) {
  Diagnostics diagnostics;
  load_stage_world("w.world",
                   "position(\n  ctrl \"lasernoise\"\n  ranger( sensor() ) )\n"
                   "position( pose [3 0 0 0] ranger( sensor() ctrl \"lasernoise\" ) )\n",
                   test::registry(), {}, diagnostics);
  EXPECT_THAT(
      diagnostics.warnings(),
      testing::ElementsAre("w.world:2: warning: controller \"lasernoise\" has no effect: it must be in "
                           "a ranger with a sensor( ... )"));
  EXPECT_FALSE(diagnostics.has_errors());
}

TEST(StageDemos, OtherControllersAddNothing) { EXPECT_EQ(stage_addition("rasterize"), nullptr); }

}  // namespace
}  // namespace troupe::worldio::stage_demos_test
