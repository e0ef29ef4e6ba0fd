#include "models/drives.hpp"

#include "tests/support/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace troupe::models {
namespace {

using engine::Command;
using engine::Velocity;

struct Robot {
  explicit Robot(const std::string& kind,
                 std::initializer_list<std::pair<std::string_view, engine::Value>> params = {},
                 double period_s = 0) {
    const TypeId type = scene.robot("robot", {Solid{{test::box_ring(0.4, 0.4)}, {0, 1}}}, kind);
    scene[type].drive = test::drive(kind, params);
    scene[type].drive->period_s = period_s;
    body = scene.body("r", type);
  }
  Velocity velocity(const engine::World& world) const { return world.velocities()[world.row(body).index()]; }
  test::SceneBuilder scene;
  BodyId body;
};

TEST(Conformance1, KinematicsOfADiffDrive) {
  Robot robot("diff");
  engine::World world = robot.scene.world();
  world.set_command(world.row(robot.body), {0.5, 0, 1});
  const Pose expected[] = {{0.050000, 0, 0, 0.1}, {0.099750, 0.004992, 0, 0.2}, {0.148754, 0.014925, 0, 0.3}};
  for (const Pose& pose : expected) {
    world.step();
    const Pose at = world.pose(robot.body);
    EXPECT_NEAR(at.x, pose.x, 5e-7);
    EXPECT_NEAR(at.y, pose.y, 5e-7);
    EXPECT_NEAR(at.heading, pose.heading, 1e-12);
  }
  while (world.tick() < 15) world.step();
  EXPECT_NEAR(world.pose(robot.body).x, 0.521563, 5e-7);
  EXPECT_NEAR(world.pose(robot.body).y, 0.439307, 5e-7);
  EXPECT_NEAR(world.pose(robot.body).heading, 1.5, 1e-12);
}

TEST(Conformance4, CarDriveAndItsUpdateInterval) {
  Robot robot("car", {{"wheelbase", 0.5}}, 0.25);
  engine::World world = robot.scene.world();
  world.set_command(world.row(robot.body), {1, 0, 0.3});
  // 250 ms at 100 ms ticks: updates at 0.3, 0.6, ...
  world.step();
  world.step();
  EXPECT_EQ(robot.velocity(world).x, 0);
  world.step();
  EXPECT_NEAR(robot.velocity(world).x, 0.955336, 5e-7);
  EXPECT_NEAR(robot.velocity(world).turn, 0.591040, 5e-7);
  world.set_command(world.row(robot.body), {0, 0, 0});
  world.step();
  world.step();
  EXPECT_NEAR(robot.velocity(world).x, 0.955336, 5e-7);
  world.step();
  EXPECT_EQ(robot.velocity(world).x, 0);
}

TEST(Conformance6, AStalledRobotKeepsItsPlaceAndItsVelocity) {
  Robot robot("diff");
  robot.scene.spec.bodies.back().pose_world_body.x = 3;
  robot.scene.wall(3.55, -1, 4, 1);
  engine::World world = robot.scene.world();
  world.set_command(world.row(robot.body), {0.9, 0, 0});
  for (const double x : {3.09, 3.18, 3.27}) {
    world.step();
    EXPECT_NEAR(world.pose(robot.body).x, x, 1e-12);
    EXPECT_FALSE(world.stalled(world.row(robot.body)));
  }
  // Stage's cells stop the robot one tick early, at 3.27, with 0.08 m to go; so does the next step of 0.09 m.
  for (int i = 0; i < 3; ++i) {
    world.step();
    EXPECT_NEAR(world.pose(robot.body).x, 3.27, 1e-12);
    EXPECT_TRUE(world.stalled(world.row(robot.body)));
    EXPECT_DOUBLE_EQ(robot.velocity(world).x, 0.9);
  }
}

TEST(Drives, OmniMovesSideways) {
  Robot robot("omni");
  engine::World world = robot.scene.world();
  world.set_command(world.row(robot.body), {0.5, 0.3, 1});
  world.step();
  EXPECT_NEAR(world.pose(robot.body).x, 0.05, 1e-12);
  EXPECT_NEAR(world.pose(robot.body).y, 0.03, 1e-12);
}

TEST(Drives, DiffIgnoresASidewaysCommand) {
  Robot robot("diff");
  engine::World world = robot.scene.world();
  world.set_command(world.row(robot.body), {0, 0.3, 0});
  world.step();
  EXPECT_EQ(world.pose(robot.body), Pose());
  EXPECT_FALSE(world.stalled(world.row(robot.body)));
}

TEST(Drives, BoundsClampEachSpeed) {
  Robot robot("omni", {{"velocity_max_x", 0.2}, {"velocity_min_y", -0.1}, {"turn_max", 0.4}});
  engine::World world = robot.scene.world();
  world.set_command(world.row(robot.body), {5, -5, 5});
  world.step();
  EXPECT_EQ(robot.velocity(world).x, 0.2);
  EXPECT_EQ(robot.velocity(world).y, -0.1);
  EXPECT_EQ(robot.velocity(world).turn, 0.4);
}

TEST(Drives, ASpeedThatIsNoNumberNamesRobotAndTick) {
  Robot robot("diff");
  engine::World world = robot.scene.world();
  world.step();
  world.set_command(world.row(robot.body), {std::nan(""), 0, 0});
  try {
    world.step();
    FAIL() << "a speed that is no number was taken";
  } catch (const engine::StepError& error) {
    EXPECT_STREQ(error.what(), "tick 2: robot \"r\" was commanded a speed that is not a finite number");
  }
}

TEST(Drives, HeadingStaysWithinPi) {
  Robot robot("diff");
  engine::World world = robot.scene.world();
  world.set_command(world.row(robot.body), {0, 0, 1.5});
  for (int i = 0; i < 500; ++i) {
    world.step();
    ASSERT_LE(std::abs(world.pose(robot.body).heading), k_pi);
  }
}

}  // namespace
}  // namespace troupe::models
