#include "models/controllers/collector.hpp"

#include "engine/world/world.hpp"
#include "models/devices/gripper.hpp"
#include "tests/support/devices.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace troupe::models {
namespace {

/// A world with a sink at (-2, 0), a puck at (1, 0), and a robot at the origin.
struct OnePuck {
  test::SceneBuilder scene;
  std::size_t hand = 0;  ///< index of the robot's gripper
  BodyId robot;

  explicit OnePuck(double tick_s) {
    scene.spec.tick_s = tick_s;
    scene.body("sink", scene.type("sink", {test::box(1, 1, 0.01)}, {.obstacle = false, .ranger = -1}),
               {-2, 0, 0, 0});
    const TypeId puck = scene.type("puck", {test::box(0.1, 0.1, 0.1)}, {.fiducial = 1, .gripper = true});
    scene.body("puck", puck, {1, 0, 0, 0});
    const TypeId type = scene.robot("robot", {test::box(0.3, 0.24, 0.2)});
    engine::DeviceSpec finder{
        .name = "finder",
        .kind = "fiducial",
        .params = test::record(test::registry().device("fiducial")->params, {{"range_max", 2.0}}),
        .pose_body_device = {0, 0, 0.05, 0}};
    scene[type].devices = {
        test::ranger("laser", {{.pose = {0, 0, 0.15, 0}, .range_max = 2, .fov = k_pi, .samples = 19}}),
        finder};
    hand = test::add_device(scene[type], "hand", "gripper", {0.25, 0, 0, 0});
    scene[type].controllers = {test::controller("collector")};
    robot = scene.body("r", type);
  }
  const GripperState& gripper(const engine::World& world) const {
    return test::state_of<GripperState>(world, robot, hand);
  }
};

/// Number of times that a robot grips the only puck of its world within 60 s.
int grips_in_ticks_of(double tick_s) {
  OnePuck puck(tick_s);
  engine::World world = puck.scene.world({.threads = 1});
  int grips = 0;
  bool held = false;
  for (long tick = 0; tick < std::lround(60 / tick_s); ++tick) {
    world.step();
    const bool holds = puck.gripper(world).held != 0;
    grips += holds && !held;
    held = holds;
  }
  return grips;
}

TEST(Collector, BacksOffFarEnoughFromItsPuckInShortTicksToo) {
  for (const double tick_s : {0.02, 0.05, 0.1}) EXPECT_EQ(grips_in_ticks_of(tick_s), 1) << tick_s;
}

TEST(Collector, DoesNotTakeASlowDriveForAnObstacle) {
  OnePuck puck(0.1);
  puck.scene.spec.types.back().drive->period_s = 1.5;
  engine::World world = puck.scene.world({.threads = 1});
  const Row row = world.row(puck.robot);
  for (int tick = 0; tick < 25; ++tick) {
    world.step();
    EXPECT_GE(world.commands()[row.index()].x, 0) << "it backs out in tick " << tick;
  }
}

TEST(Collector, BacksOffFromASinkWhereItsPaddlesCannotOpen) {
  OnePuck puck(0.1);
  const TypeId wall = puck.scene.type("wall", {test::box(0.27, 0.04, 0.3)}, {.ranger = -1});
  for (const double y : {-0.12, 0.12}) puck.scene.body("", wall, {-1.965, y, 0, 0});
  engine::World world = puck.scene.world({.threads = 1});
  const Row row = world.row(puck.robot);
  for (int tick = 0; tick < 600 && puck.gripper(world).held == 0; ++tick) world.step();
  ASSERT_NE(puck.gripper(world).held, 0u);
  const engine::World::Placed between_walls{row, {-1.6, 0, 0, k_pi}};
  world.set_poses({&between_walls, 1});
  for (int tick = 0; tick < 25; ++tick) world.step();
  EXPECT_EQ(puck.gripper(world).stalled, 1);
  EXPECT_EQ(world.poses()[row.index()].x, -1.6);
  for (int tick = 0; tick < 50; ++tick) world.step();
  EXPECT_GT(world.poses()[row.index()].x, -1.5);
  EXPECT_EQ(puck.gripper(world).paddles, GripperState::is_open);
}

}  // namespace
}  // namespace troupe::models
