#include "models/controllers/collector.hpp"

#include "engine/world/world.hpp"
#include "models/devices/gripper.hpp"
#include "tests/support/devices.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace troupe::models {
namespace {

/// Number of times that a robot grips the only puck of its world within 60 s.
int grips_in_ticks_of(double tick_s) {
  test::SceneBuilder scene;
  scene.spec.tick_s = tick_s;
  scene.body("sink", scene.type("sink", {test::box(1, 1, 0.01)}, {.obstacle = false, .ranger = -1}),
             {-2, 0, 0, 0});
  const TypeId puck = scene.type("puck", {test::box(0.1, 0.1, 0.1)}, {.fiducial = 1, .gripper = true});
  scene.body("puck", puck, {1, 0, 0, 0});
  const TypeId robot = scene.robot("robot", {test::box(0.3, 0.24, 0.2)});
  engine::DeviceSpec finder{
      .name = "finder",
      .kind = "fiducial",
      .params = test::record(test::registry().device("fiducial")->params, {{"range_max", 2.0}}),
      .pose_body_device = {0, 0, 0.05, 0}};
  scene[robot].devices = {
      test::ranger("laser", {{.pose = {0, 0, 0.15, 0}, .range_max = 2, .fov = k_pi, .samples = 19}}), finder};
  const std::size_t hand = test::add_device(scene[robot], "hand", "gripper", {0.25, 0, 0, 0});
  scene[robot].controllers = {test::controller("collector")};
  const BodyId body = scene.body("r", robot);
  engine::World world = scene.world({.threads = 1});
  int grips = 0;
  bool held = false;
  for (long tick = 0; tick < std::lround(60 / tick_s); ++tick) {
    world.step();
    const bool holds = test::state_of<GripperState>(world, body, hand).held != 0;
    grips += holds && !held;
    held = holds;
  }
  return grips;
}

TEST(Collector, BacksOffFarEnoughFromItsPuckInShortTicksToo) {
  for (const double tick_s : {0.02, 0.05, 0.1}) EXPECT_EQ(grips_in_ticks_of(tick_s), 1) << tick_s;
}

}  // namespace
}  // namespace troupe::models
