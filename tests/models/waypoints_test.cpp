// The controller `waypoints`: bodies keep to times and speeds, and motions are resolved as those of robots.

#include "base/math.hpp"
#include "engine/world/world.hpp"
#include "models/drives/wheels.hpp"
#include "tests/support/devices.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace troupe::models::waypoints_test {
namespace {

using engine::Record;
using ::testing::HasSubstr;

struct Goal {
  double x = 0, y = 0, heading = 0;
  double at_s = 0, speed = 0, wait_s = 0;
};

engine::ControllerSpec waypoints(const std::vector<Goal>& goals, bool again = false) {
  std::vector<Record> records;
  for (const Goal& goal : goals)
    records.push_back({goal.x, goal.y, 0.0, goal.heading, goal.at_s, goal.speed, goal.wait_s});
  return test::controller("waypoints", {{"goals", records}, {"again", again}});
}

/// A body of 0.4 m that goes its way, from the origin.
struct Mover {
  test::SceneBuilder scene;
  TypeId type;
  BodyId body;

  explicit Mover(const std::vector<Goal>& goals, bool again = false, double period_s = 0) {
    type = scene.robot("mover", {test::box(0.4, 0.4)}, "omni");
    scene[type].controllers = {waypoints(goals, again)};
    scene[type].drive->period_s = period_s;
    body = scene.body("m", type);
  }
};

/// Poses after each tick, from tick 0 on.
std::vector<Pose> way_of(engine::World& world, BodyId body, int ticks) {
  std::vector<Pose> poses{world.view().pose(body)};
  for (int tick = 0; tick < ticks; ++tick) {
    world.step();
    poses.push_back(world.view().pose(body));
  }
  return poses;
}

constexpr double k_exact = 1e-9;

TEST(Movers, AreWhereTheirTimesSay) {
  // It waits at the origin until 1 s, is 2 m on at 3 s, turned by a right angle 1.2 s later, then 1 m aside.
  const Mover mover({{0, 0, 0, 1}, {2, 0, 0, 3}, {2, 0, k_pi / 2, 4.2}, {2, -1, k_pi / 2, 5.2}});
  engine::World world = mover.scene.world();
  const std::vector<Pose> way = way_of(world, mover.body, 80);
  EXPECT_EQ(way[10], Pose()) << "at 1 s";
  EXPECT_NEAR(way[11].x, 0.1, k_exact);
  EXPECT_NEAR(way[20].x, 1, k_exact) << "at 2 s, half-way";
  EXPECT_NEAR(way[30].x, 2, k_exact);
  EXPECT_NEAR(way[36].heading, k_pi / 4, k_exact) << "at 3.6 s";
  EXPECT_NEAR(way[36].x, 2, k_exact);
  EXPECT_NEAR(way[42].heading, k_pi / 2, k_exact);
  EXPECT_NEAR(way[47].y, -0.5, k_exact) << "sideways, whatever it faces";
  for (const std::size_t tick : {52u, 60u, 80u}) {
    EXPECT_NEAR(way[tick].x, 2, k_exact) << "there it stays";
    EXPECT_NEAR(way[tick].y, -1, k_exact);
  }
}

TEST(Movers, WhoseDriveIsRarelyDueAreThereInTime) {
  const Mover mover({{0, 0, 0, 1}, {1.5, 0, 0, 3}, {1.5, 1, 0, 5}}, false, 0.3);
  engine::World world = mover.scene.world();
  const std::vector<Pose> way = way_of(world, mover.body, 80);
  EXPECT_NEAR(way[30].x, 1.5, k_exact);
  EXPECT_EQ(way[30].y, 0);
  EXPECT_NEAR(way[50].y, 1, k_exact);
  EXPECT_NEAR(way[80].y, 1, k_exact);
}

TEST(Movers, WhoseDriveIsRarelyDueAreThereInTimeThoughTheyTurn) {
  const Mover mover({{0, 0, 0, 1}, {3, 0, radians(120), 5}, {3, 2, 0, 10}, {1, 2, -1, 14}}, false, 0.5);
  engine::World world = mover.scene.world();
  const std::vector<Pose> way = way_of(world, mover.body, 150);
  // The drive runs in ticks 5, 10, 15, ..., so the robot moves to its second goal in ticks 15 to 49.
  EXPECT_NEAR(way[29].x, 3 * 15.0 / 35, k_exact) << "the ends of the periods are on a straight line";
  EXPECT_NEAR(way[29].y, 0, k_exact);
  EXPECT_NEAR(way[29].heading, radians(120) * 15 / 35, k_exact);
  EXPECT_NEAR(way[50].x, 3, k_exact);
  EXPECT_NEAR(way[50].y, 0, k_exact);
  EXPECT_NEAR(way[50].heading, radians(120), k_exact);
  EXPECT_NEAR(way[100].x, 3, k_exact);
  EXPECT_NEAR(way[100].y, 2, k_exact);
  EXPECT_NEAR(way[100].heading, 0, k_exact);
  for (const std::size_t tick : {140u, 150u}) {
    EXPECT_NEAR(way[tick].x, 1, k_exact);
    EXPECT_NEAR(way[tick].y, 2, k_exact);
    EXPECT_NEAR(way[tick].heading, -1, k_exact);
  }
}

TEST(Movers, GoAtTheirSpeedsAndWait) {
  const Mover mover({{1, 0, 0, 0, 0.5, 0.7}, {1, 1, 0, 0, 0.25}});
  engine::World world = mover.scene.world();
  const std::vector<Pose> way = way_of(world, mover.body, 90);
  EXPECT_EQ(way[1].x, 0) << "a command acts a tick after it is given";
  EXPECT_NEAR(way[2].x, 0.05, k_exact);
  EXPECT_NEAR(way[21].x, 1, k_exact);
  EXPECT_NEAR(way[28].y, 0, k_exact) << "0.7 s";
  EXPECT_NEAR(way[29].y, 0.025, k_exact);
  EXPECT_NEAR(way[68].y, 1, k_exact);
  EXPECT_NEAR(way[90].y, 1, k_exact);
}

TEST(Movers, WaitAgainAtAGoalFromWhichTheyWereMovedAway) {
  const Mover mover({{0, 0, 0, 0, 0, 5}, {2, 0}});
  engine::World world = mover.scene.world();
  way_of(world, mover.body, 40);
  world.set_poses(std::vector<engine::World::Placed>{{world.view().row(mover.body), {-1, 0, 0, 0}}});
  int back = 0;
  for (; world.view().pose(mover.body).x < -0.1 && back < 50; ++back) world.step();
  EXPECT_LT(back, 50);
  for (const Pose& pose : way_of(world, mover.body, 49)) EXPECT_NEAR(pose.x, 0, 0.1);
  way_of(world, mover.body, 50);
  EXPECT_GT(world.view().pose(mover.body).x, 0.5);
}

TEST(Movers, BeginAgainAfterTheLastGoal) {
  const Mover mover({{0, 0, 0, 1}, {1, 0, 0, 2}, {1, 0, 0, 3}, {0, 0, 0, 4}}, true);
  engine::World world = mover.scene.world();
  const std::vector<Pose> way = way_of(world, mover.body, 130);
  for (const int round : {0, 40, 80}) {
    EXPECT_NEAR(way[static_cast<std::size_t>(round) + 10].x, 0, k_exact) << round;
    EXPECT_NEAR(way[static_cast<std::size_t>(round) + 15].x, 0.5, k_exact) << round;
    EXPECT_NEAR(way[static_cast<std::size_t>(round) + 30].x, 1, k_exact) << round;
    EXPECT_NEAR(way[static_cast<std::size_t>(round) + 38].x, 0.2, k_exact) << round;
  }
}

TEST(Movers, StopBeforeWhatStandsInTheirWayAndHurryThen) {
  Mover mover({{0, 0, 0, 1}, {4, 0, 0, 9}, {4, 0, 0, 12}});  // at 0.5 m/s
  const TypeId crate = mover.scene.robot("crate", {test::box(0.4, 0.4)});
  const BodyId other = mover.scene.body("crate", crate, {2, 0, 0, 0});
  engine::World world = mover.scene.world();
  std::vector<Pose> way = way_of(world, mover.body, 50);
  EXPECT_GT(way[50].x, 1.5);
  EXPECT_LE(way[50].x, 1.6 + k_exact) << "it touches, and goes no farther";
  world.set_poses(std::vector<engine::World::Placed>{{world.view().row(other), {2, 3, 0, 0}}});
  way = way_of(world, mover.body, 20);
  EXPECT_NEAR(way[20].x, way[0].x + 1, 0.45) << "between 0.6 m/s, which is enough, and 1 m/s";
  way = way_of(world, mover.body, 20);
  EXPECT_NEAR(way[20].x, 4, k_exact) << "at 9 s, in time";
}

TEST(Movers, WhoIsLateGoesAsFastAsItCanAndLeavesNoGoalOut) {
  Mover mover({{0, 0, 0, 1}, {1, 0, 0, 2}, {1, 2, 0, 6}});
  const BodyId wall =
      mover.scene.body("crate", mover.scene.robot("crate", {test::box(0.4, 0.4)}), {0.41, 0, 0, 0});
  engine::World world = mover.scene.world();
  std::vector<Pose> way = way_of(world, mover.body, 30);
  EXPECT_LE(way[30].x, 0.01 + k_exact);
  world.set_poses(std::vector<engine::World::Placed>{{world.view().row(wall), {9, 9, 0, 0}}});
  way = way_of(world, mover.body, 12);
  EXPECT_NEAR(way[11].x, 1, 0.02) << "1 m/s is all its drive gives";
  EXPECT_NEAR(way[11].y, 0, 0.15);
  way = way_of(world, mover.body, 18);
  EXPECT_NEAR(way[18].y, 2, k_exact) << "and at 6 s it is where it should be";
}

TEST(Movers, WithoutObstaclesOfTheirOwnTheyPassThroughAll) {
  Mover mover({{0, 0, 0, 1}, {4, 0, 0, 5}});
  mover.scene[mover.type].parts[0].returns.obstacle = false;
  mover.scene.wall(1, -1, 1.2, 1);
  engine::World world = mover.scene.world();
  EXPECT_NEAR(way_of(world, mover.body, 50).back().x, 4, k_exact);
}

TEST(Movers, WhatTheyCannotKeepIsTold) {
  EXPECT_THAT(Mover({{1, 0, 0, 0, 2}}).scene.error(),
              HasSubstr("controller \"waypoints\" cannot follow goal 1 (counted from 1): its `speed` is 2 "
                        "m/s, but the drive reaches 1 m/s in its slowest direction: give a lower `speed`"));
  EXPECT_THAT(Mover({{0, 0, 0, 1}, {3, 0, 0, 2}}).scene.error(),
              HasSubstr("cannot follow goal 2 (counted from 1): it is 3 m from the goal before it, and the "
                        "robot has 1 s for this way, from the `at` plus `wait` of the goal before it to its "
                        "own `at`, but the drive reaches 1 m/s in its slowest"));
  EXPECT_THAT(
      Mover({{0, 0, 0, 1}, {1, 0, -3, 2}}).scene.error(),
      HasSubstr("cannot follow goal 2 (counted from 1): its heading differs by 3 rad from that of the "
                "goal before it, and the robot has 1 s for this turn, from the `at` plus `wait` of "
                "the goal before it to its own `at`, but the drive reaches 1.5708 rad/s to its "
                "slower side: give this goal a later `at`"));
  EXPECT_EQ(Mover({{0, 0, -3, 1}, {1, 0, 3, 2}}).scene.error(), "") << "it turns by the smaller angle";
  EXPECT_THAT(Mover({{0, 0, 0, 3}, {1, 0, 0, 2}}).scene.error(),
              HasSubstr("cannot follow goal 2 (counted from 1): its `at` is 2 s, but that of the goal before "
                        "it is 3 s; times "
                        "must increase"));
  EXPECT_THAT(
      Mover({{1, 0, 0, 3, 1}}).scene.error(),
      HasSubstr("cannot follow goal 1 (counted from 1): it has both `at` and `speed`; give only one"));
  Mover diff({{1, 0, 0, 3}});
  diff.scene[diff.type].drive = test::drive("diff");
  EXPECT_THAT(diff.scene.error(), HasSubstr("which need a drive of kind \"omni\""));
}

/// A body without a drive, with a part "cart" that has wheels of its own and goes its way, from the origin.
struct Cart {
  test::SceneBuilder scene;
  TypeId type;
  BodyId body;

  Cart(const std::vector<Goal>& goals, const std::string& law) {
    type = scene.type("base", {test::box(0.2, 0.2)});
    scene[type].parts.push_back({.name = "cart", .solids = {test::box(0.1, 0.1)}});
    const std::size_t wheels = test::add_device(scene[type], "cart", "wheels", {}, {{"drive", law}});
    scene[type].devices[wheels].part = 1;
    scene[type].parts[1].joint = scene[type].devices[wheels].moves;
    scene[type].controllers = {waypoints(goals)};
    scene[type].controllers[0].part = 1;
    body = scene.body("b", type);
  }
  engine::DeviceSpec& wheels() { return scene[type].devices[0]; }
  /// The place of the part at the start of the last tick.
  Vec2 place(const engine::World& world) const {
    const auto& state = test::state_of<WheelsState>(world, body, 0);
    return {state.x, state.y};
  }
};

TEST(Movers, OnWheelsHaveTheDriveOfTheirWheels) {
  Cart cart({{1, 0, 0, 0, 0.5}, {1, 1, 0, 0, 0.5}}, "omni");
  engine::World world = cart.scene.world();
  while (world.tick() < 21) world.step();
  EXPECT_NEAR(cart.place(world).x(), 0.95, k_exact)
      << "at 2 s, because a command acts a tick after it is given";
  while (world.tick() < 50) world.step();
  EXPECT_NEAR(cart.place(world).y(), 1, k_exact);

  Cart diff({{1, 0, 0, 0, 0.5}}, "diff");
  diff.scene[diff.type].drive = test::drive("omni");
  EXPECT_THAT(diff.scene.error(), HasSubstr("which need a drive of kind \"omni\", found \"diff\""));
}

TEST(Movers, OnWheelsThatRunAtOtherTimesThanTheControllerAreAnError) {
  Cart cart({{1, 0, 0, 0, 0.5}}, "omni");
  cart.scene[cart.type].drive = test::drive("omni");
  cart.scene[cart.type].drive->period_s = 0.5;
  EXPECT_THAT(cart.scene.error(),
              HasSubstr("which need wheels that run once per decision, but \"cart\" runs every 0.1 s and the "
                        "controller decides every 0.5 s: give both the same `period`"));
  cart.wheels().period_s = 0.5;
  EXPECT_EQ(cart.scene.error(), "");
}

/// An omni drive that reaches `speed` in every direction, m/s.
Record drive_of(double speed) {
  return test::drive("omni", {{"velocity_min_x", -speed},
                              {"velocity_max_x", speed},
                              {"velocity_min_y", -speed},
                              {"velocity_max_y", speed}})
      .params;
}

/// An intervention that changes the drive of the mover at a time, s.
engine::InterventionSpec set_drive(const Mover& mover, double time_s, double speed) {
  engine::InterventionSpec set;
  set.time_s = time_s;
  set.action = engine::InterventionSpec::Action::set;
  set.setting = engine::SettingSpec{mover.type, engine::SettingSpec::Of::drive, 0, drive_of(speed)};
  return set;
}

TEST(Movers, KnowTheDriveThatAnInterventionSets) {
  Mover mover({{5, 0, 0, 1}});
  mover.scene[mover.type].drive->params = drive_of(0.25);
  mover.scene.spec.experiment.at = {set_drive(mover, 2, 1)};
  engine::World world = mover.scene.world();
  const std::vector<Pose> poses = way_of(world, mover.body, 30);
  EXPECT_LE(poses[20].x, 0.5 + k_exact) << "it is late, and the drive is slow";
  EXPECT_NEAR(poses[30].x - poses[22].x, 0.8, k_exact);
  world.reset();
  const std::vector<Pose> again = way_of(world, mover.body, 30);
  EXPECT_EQ(again[20], poses[20]) << "the reset has also restored the limits";
  EXPECT_EQ(again[30], poses[30]);
}

TEST(Movers, KnowTheWheelsThatAnInterventionSets) {
  Cart cart({{5, 0, 0, 0, 0.8}}, "omni");
  engine::InterventionSpec set;
  set.time_s = 1;
  set.action = engine::InterventionSpec::Action::set;
  set.setting = engine::SettingSpec{
      cart.type, engine::SettingSpec::Of::device, 0,
      test::record(test::registry().device("wheels")->params, {{"drive", "omni"}, {"velocity_max_x", 0.25}})};
  cart.scene.spec.experiment.at = {set};
  EXPECT_THAT(cart.scene.error(), HasSubstr("cannot follow goal 1 (counted from 1): its `speed` is 0.8 m/s, "
                                            "but the drive reaches 0.25 m/s"));
}

TEST(Movers, ADriveThatAnInterventionMakesTooSlowIsAnError) {
  Mover mover({{3, 4, 0, 0, 0.8}});
  mover.scene.spec.experiment.at = {set_drive(mover, 1, 0.25)};
  EXPECT_THAT(mover.scene.error(),
              HasSubstr("controller \"waypoints\" cannot follow goal 1 (counted from 1): its "
                        "`speed` is 0.8 m/s, but the drive reaches 0.25 m/s"));
}

}  // namespace
}  // namespace troupe::models::waypoints_test
