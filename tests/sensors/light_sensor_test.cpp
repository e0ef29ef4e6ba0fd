#include "sensors/light_sensor.hpp"

#include "engine/world/world.hpp"
#include "tests/support/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace troupe::sensors::light_sensor_test {
namespace {

using engine::World;
using test::box;
using test::device;
using test::SceneBuilder;
using Params = std::vector<std::pair<std::string_view, engine::Value>>;

struct LightScene : SceneBuilder {
  /// At the origin, looking along +y, 0.3 m high.
  BodyId robot_with(const Params& params = {}) {
    const TypeId id = robot("robot", {box(0.2, 0.2)});
    (*this)[id].devices = {device("light_sensor", params, {0, 0, 0.3, 0})};
    return body("r", id, {0, 0, 0, k_pi / 2});
  }
  BodyId lamp(double x, double y, double intensity, double height = 0.3, double duty = 1) {
    const std::string name = "lamp" + std::to_string(spec.bodies.size());
    const TypeId id = type(name, {box(0.1, 0.1, 0.4)});
    (*this)[id].devices = {device(
        "blinkenlight", {{"intensity", intensity}, {"period", 0.4}, {"dutycycle", duty}}, {0, 0, height, 0})};
    return body(name, id, {x, y, 0, 0});
  }
};

struct Reading {
  std::vector<float> brightness;
  std::uint32_t sources = 0;
};
Reading reading(const World& world, BodyId body) {
  const Row row = world.view().row(body);
  const engine::StateTable& table = world.tables()[world.view().type(row).devices[0].table];
  const auto brightness = table.cell<float>(world.view().slot(row), k_light_brightness);
  return {{brightness.begin(), brightness.end()},
          table.cell<std::uint32_t>(world.view().slot(row), k_light_sources)[0]};
}
Reading after(const SceneBuilder& scene, BodyId body, int ticks) {
  World world = scene.world();
  for (int tick = 0; tick < ticks; ++tick) world.step();
  return reading(world, body);
}

TEST(LightSensor, BrightnessFallsWithTheSquareOfTheDistanceAndTheCosine) {
  LightScene scene;
  const BodyId robot = scene.robot_with();
  scene.lamp(0, 2, 8);  // 2 m ahead
  EXPECT_EQ(after(scene, robot, 1).sources, 0u)
      << "it is lit from the first tick on, which the second one sees";
  const Reading one = after(scene, robot, 2);
  EXPECT_EQ(one.sources, 1u);
  ASSERT_EQ(one.brightness.size(), 8u);
  EXPECT_NEAR(one.brightness[0], 8 / 4.0, 1e-6);
  EXPECT_NEAR(one.brightness[1], 2 * std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(one.brightness[7], 2 * std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(one.brightness[2], 0, 1e-6);
  EXPECT_EQ(one.brightness[4], 0);
  scene.lamp(-1, 0, 3);  // 1 m to the left
  const Reading two = after(scene, robot, 2);
  EXPECT_EQ(two.sources, 2u);
  EXPECT_NEAR(two.brightness[0], 2, 1e-6);
  EXPECT_NEAR(two.brightness[1], (2 + 3) * std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(two.brightness[2], 3, 1e-6);
}

TEST(LightSensor, ALightHigherUpIsFarther) {
  LightScene scene;
  const BodyId robot = scene.robot_with({{"directions", 1}});
  scene.lamp(0, 3, 125, 4.3);  // 3 m ahead and 4 m up: 5 m away, at a cosine of 3/5
  EXPECT_NEAR(after(scene, robot, 2).brightness[0], 125 / 25.0 * 0.6, 1e-5);
}

TEST(LightSensor, WallsAndBodiesStandBefore) {
  LightScene scene;
  const BodyId robot = scene.robot_with();
  scene.lamp(0, 2, 4);
  LightScene with_wall = scene;
  with_wall.wall(-1, 1, 1, 1.1);
  EXPECT_EQ(after(with_wall, robot, 2).sources, 0u);
  LightScene with_crate = scene;
  with_crate.body("crate", with_crate.robot("crate", {box(0.2, 0.2)}), {0, 1, 0, 0});
  EXPECT_EQ(after(with_crate, robot, 2).sources, 0u);
  LightScene with_low = scene;
  with_low.body("low", with_low.robot("low", {box(0.2, 0.2, 0.2)}), {0, 1, 0, 0});
  EXPECT_EQ(after(with_low, robot, 2).sources, 1u);
  LightScene through;
  const BodyId seer = through.robot_with({{"occlusion", false}});
  through.lamp(0, 2, 4);
  through.wall(-1, 1, 1, 1.1);
  EXPECT_EQ(after(through, seer, 2).sources, 1u);
}

TEST(LightSensor, AWallBehindAPartOfTheLampsBodyHidesTheLamp) {
  LightScene scene;
  const BodyId robot = scene.robot_with();
  const BodyId lamp = scene.lamp(0, 3, 9);
  scene[scene.spec.bodies[lamp.index()].type].parts.push_back(
      {.name = "post", .kind = "model", .solids = {placed(box(0.1, 0.1), {0, -2, 0, 0})}});  // 1 m ahead
  EXPECT_EQ(after(scene, robot, 2).sources, 1u);
  scene.wall(-1, 2, 1, 2.1);
  EXPECT_EQ(after(scene, robot, 2).sources, 0u);
}

TEST(LightSensor, DarkAndFarLightsAreNotSeen) {
  LightScene scene;
  const BodyId robot = scene.robot_with({{"range_max", 3.0}});
  scene.lamp(0, 2, 1, 0.3, 0);    // dark
  scene.lamp(0, -3.1, 1);         // too far
  scene.lamp(1, 0, 1, 0.3, 0.5);  // lit for two ticks of four
  World world = scene.world();
  std::vector<std::uint32_t> counts;
  for (int tick = 0; tick < 9; ++tick) {
    world.step();
    counts.push_back(reading(world, robot).sources);
  }
  EXPECT_EQ(counts, (std::vector<std::uint32_t>{0, 1, 0, 0, 1, 1, 0, 0, 1}));
}

TEST(LightSensor, SeesUpToItsRangeAndStraightUpWithoutBrightness) {
  LightScene above;
  const BodyId below = above.robot_with();
  above.lamp(0, 0, 9, 2);  // in sight, but in no direction
  EXPECT_EQ(after(above, below, 2).sources, 1u);
  EXPECT_EQ(after(above, below, 2).brightness, std::vector<float>(8, 0));
  LightScene scene;
  const BodyId robot = scene.robot_with({{"range_max", 3.0}});
  scene.lamp(0, 3, 9);
  EXPECT_EQ(after(scene, robot, 2).sources, 1u);
  EXPECT_FLOAT_EQ(after(scene, robot, 2).brightness[0], 1);
}

}  // namespace
}  // namespace troupe::sensors::light_sensor_test
