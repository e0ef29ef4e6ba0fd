#include "models/controllers/collector.hpp"

#include "engine/world/world.hpp"
#include "models/devices/gripper.hpp"
#include "tests/support/devices.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <vector>

namespace troupe::models::collector_test {
namespace {

/// A world with a sink at (-2, 0), a puck at (1, 0), and a robot at the origin. With several sites, the world
/// contains these three bodies several times, 10 m apart.
struct OnePuck {
  test::SceneBuilder scene;
  std::size_t hand = 0;  ///< index of the gripper of each robot
  BodyId robot;          ///< the robot of the first site
  std::vector<BodyId> robots;

  explicit OnePuck(double tick_s, int sites = 1) {
    scene.spec.tick_s = tick_s;
    const TypeId sink = scene.type("sink", {test::box(1, 1, 0.01)}, {.obstacle = false, .ranger = -1});
    const TypeId puck = scene.type("puck", {test::box(0.1, 0.1, 0.1)}, {.fiducial = 1, .gripper = true});
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
    for (int site = 0; site < sites; ++site) {
      const double y = 10.0 * site;
      scene.body("sink" + std::to_string(site), sink, {-2, y, 0, 0});
      scene.body("", puck, {1, y, 0, 0});
      robots.push_back(scene.body("", type, {0, y, 0, 0}));
    }
    robot = robots.front();
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

/// Durations, s, of the turns with which 100 robots leave their sinks.
std::vector<double> turns_in_ticks_of(double tick_s) {
  OnePuck pucks(tick_s, 100);
  engine::World world = pucks.scene.world({.threads = 1});
  std::vector<double> turns(pucks.robots.size(), 0);
  for (long tick = 0; tick < std::lround(40 / tick_s); ++tick) {
    world.step();
    for (std::size_t i = 0; i < turns.size(); ++i) {
      const engine::Command& command = world.view().commands()[world.view().row(pucks.robots[i]).index()];
      if (command.x == 0 && std::abs(command.turn) == 0.8) turns[i] += tick_s;
    }
  }
  return turns;
}

// A draw per decision would end most turns after little more than the least time, the sooner the shorter the
// ticks are.
TEST(Collector, TurnsAwayForTimesThatDoNotDependOnTheTick) {
  for (const double tick_s : {0.02, 0.1}) {
    const std::vector<double> turns = turns_in_ticks_of(tick_s);
    EXPECT_GT(std::ranges::min(turns), 1 - 1e-9) << tick_s;
    EXPECT_LT(std::ranges::max(turns), 3 - 1e-9) << tick_s;
    const double mean = std::accumulate(turns.begin(), turns.end(), 0.0) / static_cast<double>(turns.size());
    EXPECT_NEAR(mean, 2, 0.2) << tick_s << ": the standard deviation of the mean is 0.06";
  }
}

TEST(Collector, DoesNotTakeASlowDriveForAnObstacle) {
  OnePuck puck(0.1);
  puck.scene.spec.types.back().drive->period_s = 1.5;
  engine::World world = puck.scene.world({.threads = 1});
  const Row row = world.view().row(puck.robot);
  for (int tick = 0; tick < 25; ++tick) {
    world.step();
    EXPECT_GE(world.view().commands()[row.index()].x, 0) << "it backs out in tick " << tick;
  }
}

TEST(Collector, BacksOffFromASinkWhereItsPaddlesCannotOpen) {
  OnePuck puck(0.1);
  const TypeId wall = puck.scene.type("wall", {test::box(0.27, 0.04, 0.3)}, {.ranger = -1});
  for (const double y : {-0.12, 0.12}) puck.scene.body("", wall, {-1.965, y, 0, 0});
  engine::World world = puck.scene.world({.threads = 1});
  const Row row = world.view().row(puck.robot);
  for (int tick = 0; tick < 600 && puck.gripper(world).held == 0; ++tick) world.step();
  ASSERT_NE(puck.gripper(world).held, 0u);
  const engine::World::Placed between_walls{row, {-1.6, 0, 0, k_pi}};
  world.set_poses({&between_walls, 1});
  for (int tick = 0; tick < 25; ++tick) world.step();
  EXPECT_EQ(puck.gripper(world).stalled, 1);
  EXPECT_EQ(world.view().poses()[row.index()].x, -1.6);
  double farthest = -1.6;  // from the sink; afterwards the robot drives on, wherever its turn ended
  for (int tick = 0; tick < 50; ++tick) {
    world.step();
    farthest = std::max(farthest, world.view().poses()[row.index()].x);
  }
  EXPECT_GT(farthest, -1.5);
  EXPECT_EQ(puck.gripper(world).paddles, GripperState::is_open);
}

}  // namespace
}  // namespace troupe::models::collector_test
