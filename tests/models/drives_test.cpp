#include "models/drives/drives.hpp"

#include "engine/kinds/make_drive_kind.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scene.hpp"

#include <gtest/gtest.h>

#include <any>
#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

namespace troupe::models::drives_test {
namespace {

using engine::Command;
using engine::ControlMode;
using engine::Velocity;

constexpr auto k_accelerate = ControlMode::acceleration;
constexpr auto k_go_to = ControlMode::position;

struct Robot {
  /// Parameters that the kind does not have are left out.
  explicit Robot(const std::string& kind,
                 std::initializer_list<std::pair<std::string_view, engine::Value>> params = {},
                 double period_s = 0) {
    const TypeId type = scene.robot("robot", {Solid{{test::box_ring(0.4, 0.4)}, {0, 1}}}, kind);
    const engine::FieldTable& table = test::registry().drive(kind)->params;
    for (const auto& [name, value] : params)
      if (const int at = table.find(name); at >= 0)
        scene[type].drive->params[static_cast<std::size_t>(at)] = value;
    scene[type].drive->period_s = period_s;
    body = scene.body("r", type);
  }
  Velocity velocity(const engine::World& world) const {
    return world.view().velocities()[world.view().row(body).index()];
  }
  test::SceneBuilder scene;
  BodyId body;
};

TEST(Conformance01, KinematicsOfADiffDrive) {
  Robot robot("diff");
  engine::World world = robot.scene.world();
  world.set_command(world.view().row(robot.body), {0.5, 0, 1});
  const Pose expected[] = {{0.050000, 0, 0, 0.1}, {0.099750, 0.004992, 0, 0.2}, {0.148754, 0.014925, 0, 0.3}};
  for (const Pose& pose : expected) {
    world.step();
    const Pose at = world.view().pose(robot.body);
    EXPECT_NEAR(at.x, pose.x, 5e-7);
    EXPECT_NEAR(at.y, pose.y, 5e-7);
    EXPECT_NEAR(at.heading, pose.heading, 1e-12);
  }
  while (world.tick() < 15) world.step();
  EXPECT_NEAR(world.view().pose(robot.body).x, 0.521563, 5e-7);
  EXPECT_NEAR(world.view().pose(robot.body).y, 0.439307, 5e-7);
  EXPECT_NEAR(world.view().pose(robot.body).heading, 1.5, 1e-12);
}

TEST(Conformance04, CarDriveAndItsUpdateInterval) {
  Robot robot("car", {{"wheelbase", 0.5}}, 0.25);
  engine::World world = robot.scene.world();
  world.set_command(world.view().row(robot.body), {1, 0, 0.3});
  // 250 ms at 100 ms ticks: updates at 0.3, 0.6, ...
  world.step();
  world.step();
  EXPECT_EQ(robot.velocity(world).x, 0);
  world.step();
  EXPECT_NEAR(robot.velocity(world).x, 0.955336, 5e-7);
  EXPECT_NEAR(robot.velocity(world).turn, 0.591040, 5e-7);
  world.set_command(world.view().row(robot.body), {0, 0, 0});
  world.step();
  world.step();
  EXPECT_NEAR(robot.velocity(world).x, 0.955336, 5e-7);
  world.step();
  EXPECT_EQ(robot.velocity(world).x, 0);
}

TEST(Conformance06, AStalledRobotKeepsItsPlaceAndItsVelocity) {
  Robot robot("diff");
  robot.scene.spec.bodies.back().pose_world_body.x = 3;
  robot.scene.wall(3.55, -1, 4, 1);
  engine::World world = robot.scene.world();
  world.set_command(world.view().row(robot.body), {0.9, 0, 0});
  for (const double x : {3.09, 3.18, 3.27}) {
    world.step();
    EXPECT_NEAR(world.view().pose(robot.body).x, x, 1e-12);
    EXPECT_FALSE(world.view().stalled(world.view().row(robot.body)));
  }
  // Stage's cells stop the robot one tick early, at 3.27, with 0.08 m to go; so does the next step of 0.09 m.
  for (int i = 0; i < 3; ++i) {
    world.step();
    EXPECT_NEAR(world.view().pose(robot.body).x, 3.27, 1e-12);
    EXPECT_TRUE(world.view().stalled(world.view().row(robot.body)));
    EXPECT_DOUBLE_EQ(robot.velocity(world).x, 0.9);
  }
}

TEST(Drives, OmniMovesSideways) {
  Robot robot("omni");
  engine::World world = robot.scene.world();
  world.set_command(world.view().row(robot.body), {0.5, 0.3, 1});
  world.step();
  EXPECT_NEAR(world.view().pose(robot.body).x, 0.05, 1e-12);
  EXPECT_NEAR(world.view().pose(robot.body).y, 0.03, 1e-12);
}

TEST(Drives, DiffIgnoresASidewaysCommand) {
  Robot robot("diff");
  engine::World world = robot.scene.world();
  world.set_command(world.view().row(robot.body), {0, 0.3, 0});
  world.step();
  EXPECT_EQ(world.view().pose(robot.body), Pose());
  EXPECT_FALSE(world.view().stalled(world.view().row(robot.body)));
}

TEST(Drives, BoundsClampEachSpeed) {
  Robot robot("omni", {{"velocity_max_x", 0.2}, {"velocity_min_y", -0.1}, {"turn_max", 0.4}});
  engine::World world = robot.scene.world();
  world.set_command(world.view().row(robot.body), {5, -5, 5});
  world.step();
  EXPECT_EQ(robot.velocity(world).x, 0.2);
  EXPECT_EQ(robot.velocity(world).y, -0.1);
  EXPECT_EQ(robot.velocity(world).turn, 0.4);
}

TEST(Drives, ASpeedThatIsNoNumberNamesRobotAndTick) {
  Robot robot("diff");
  engine::World world = robot.scene.world();
  world.step();
  world.set_command(world.view().row(robot.body), {std::nan(""), 0, 0});
  EXPECT_EQ(test::message_of<engine::StepError>([&] { world.step(); }),
            "tick 2: robot \"r\" was commanded a speed that is not a finite number");
}

/// A drive that computes a velocity that is not a number from the command 1.
struct BrokenDrive {
  struct Params {
    static constexpr void describe(engine::Description<Params>&) {}
  };

  Params params;

  void drive(const engine::DriveBatch& batch) const {
    for (std::size_t i = 0; i < batch.commands.size(); ++i)
      batch.velocities[i] = {batch.commands[i].x == 1 ? std::nan("") : 0, 0, 0};
  }
};

TEST(Drives, AComputedVelocityThatIsNoNumberNamesRobotAndTick) {
  engine::Registry registry = test::registry();
  registry.drives.push_back(engine::make_drive_kind<BrokenDrive>("broken", "for this test"));
  Robot robot("diff");
  robot.scene.spec.types[1].drive = engine::DriveSpec{.kind = "broken"};
  Diagnostics diagnostics(robot.scene.spec.files);
  engine::World world(robot.scene.spec, registry, {.threads = 1}, diagnostics);
  world.step();
  world.set_command(world.view().row(robot.body), {1, 0, 0});
  EXPECT_EQ(test::message_of<engine::StepError>([&] { world.step(); }),
            "tick 2: the drive of robot \"r\" computed a velocity that is not a finite number");
}

/// The error of making a world whose robot has a drive of this kind.
std::string error_of_making(engine::DriveKind kind) {
  kind.name = "broken";
  engine::Registry registry = test::registry();
  registry.drives.push_back(kind);
  Robot robot("diff");
  robot.scene.spec.files = std::make_shared<SourceFiles>();
  const Where where{robot.scene.spec.files->add("w.json"), 7};
  robot.scene.spec.types[1].drive = engine::DriveSpec{.kind = "broken", .where = where};
  Diagnostics diagnostics(robot.scene.spec.files);
  try {
    engine::World(robot.scene.spec, registry, {.threads = 1}, diagnostics);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "no error";
}

TEST(Drives, AnExceptionOfAHookNamesDriveAndLine) {
  const engine::DriveKind broken = engine::make_drive_kind<BrokenDrive>("broken", "for this test");
  EXPECT_EQ(error_of_making(broken), "no error");
  engine::DriveKind kind = broken;
  kind.check = [](const engine::Record&) -> Result<> { throw std::runtime_error("no check"); };
  EXPECT_EQ(error_of_making(kind), "w.json:7: error: drive \"broken\" threw: no check");
  kind = broken;
  kind.prepare = [](const engine::Record&) -> std::any { throw std::runtime_error("no data"); };
  EXPECT_EQ(error_of_making(kind), "w.json:7: error: drive \"broken\" threw: no data");
  kind = broken;
  kind.pushes = [](const engine::Record&) -> std::int64_t { throw std::runtime_error("no number"); };
  EXPECT_EQ(error_of_making(kind), "w.json:7: error: drive \"broken\" threw: no number");
}

TEST(Drives, AFirstVelocityThatIsNoNumberNamesRobotAndDrive) {
  engine::DriveKind kind = engine::make_drive_kind<BrokenDrive>("broken", "for this test");
  kind.start = [](const std::any&) -> engine::Velocity { return {std::nan(""), 0, 0}; };
  EXPECT_EQ(error_of_making(kind),
            "tick 0: drive \"broken\" of \"r\" starts with the velocity x nan, y 0 (m/s), turn 0 (rad/s) "
            "(DriveKind::start): the numbers must be finite");
}

TEST(Drives, AnAccelerationOrAGoalThatIsNoNumberNamesRobotAndTick) {
  const std::pair<ControlMode, const char*> asked[] = {
      {k_accelerate, "tick 1: robot \"r\" was commanded an acceleration that is not a finite number"},
      {k_go_to, "tick 1: robot \"r\" was commanded to drive to a goal pose that is not finite"}};
  for (const auto& [mode, text] : asked) {
    for (const char* kind : {"diff", "omni", "car"}) {
      Robot robot(kind);
      engine::World world = robot.scene.world();
      world.set_command(world.view().row(robot.body), {std::nan(""), 0, 0, mode});
      try {
        world.step();
        FAIL() << kind << ": it was taken";
      } catch (const engine::StepError& error) {
        EXPECT_STREQ(error.what(), text);
      }
    }
  }
}

TEST(Drives, AccelerationGrowsWithinItsBoundsAndThoseOfSpeed) {
  Robot robot("diff",
              {{"acceleration_max_x", 0.5}, {"velocity_max_x", 0.12}, {"turn_acceleration_min", -2.0}});
  engine::World world = robot.scene.world();
  const Row row = world.view().row(robot.body);
  world.set_command(row, {3, 3, -1, k_accelerate});
  // 0.5 m/s^2 and -1 rad/s^2 over ticks of 0.1 s; what lies across a diff is nothing.
  for (const double speed : {0.05, 0.10, 0.12, 0.12}) {
    world.step();
    EXPECT_NEAR(robot.velocity(world).x, speed, 1e-12);
    EXPECT_EQ(robot.velocity(world).y, 0);
  }
  EXPECT_NEAR(robot.velocity(world).turn, -0.4, 1e-12);
  // A speed is one at once, whatever the bounds of accelerations.
  world.set_command(row, {-1, 0, 0});
  world.step();
  EXPECT_EQ(robot.velocity(world).x, -1);
}

TEST(Drives, OmniAcceleratesSideways) {
  Robot robot("omni", {{"acceleration_min_y", -0.3}});
  engine::World world = robot.scene.world();
  world.set_command(world.view().row(robot.body), {0.1, -1, 0.2, k_accelerate});
  for (int i = 0; i < 3; ++i) world.step();
  EXPECT_NEAR(robot.velocity(world).x, 0.03, 1e-12);
  EXPECT_NEAR(robot.velocity(world).y, -0.09, 1e-12);
  EXPECT_NEAR(robot.velocity(world).turn, 0.06, 1e-12);
}

TEST(Drives, ACarAcceleratesItsFrontWheels) {
  Robot robot("car", {{"wheelbase", 0.5}});
  engine::World world = robot.scene.world();
  const Row row = world.view().row(robot.body);
  world.set_command(row, {-0.5, 0, 0.3, k_accelerate});
  for (int i = 0; i < 4; ++i) world.step();  // the wheels roll at -0.2 m/s
  EXPECT_NEAR(robot.velocity(world).x, -0.2 * std::cos(0.3), 1e-12);
  EXPECT_NEAR(robot.velocity(world).turn, -0.2 * std::sin(0.3) / 0.5, 1e-12);
  // Straight on they roll as fast.
  world.set_command(row, {0, 0, 0, k_accelerate});
  world.step();
  EXPECT_NEAR(robot.velocity(world).x, -0.2, 1e-12);
}

TEST(Drives, ACarAcceleratesWithWheelsThatPointBackwards) {
  for (const double angle : {2.0, -2.0, 3.1}) {
    Robot robot("car", {{"wheelbase", 0.5}});
    engine::World world = robot.scene.world();
    world.set_command(world.view().row(robot.body), {0.5, 0, angle, k_accelerate});
    for (int i = 0; i < 4; ++i) world.step();  // the wheels roll at 0.2 m/s
    EXPECT_NEAR(robot.velocity(world).x, 0.2 * std::cos(angle), 1e-12) << angle;
    EXPECT_NEAR(robot.velocity(world).turn, 0.2 * std::sin(angle) / 0.5, 1e-12) << angle;
  }
}

TEST(Drives, AccelerationCountsTheTimeBetweenUpdates) {
  // Stage adds a tick's worth an update, however rarely those come.
  Robot robot("diff", {}, 0.3);
  engine::World world = robot.scene.world();
  world.set_command(world.view().row(robot.body), {0.5, 0, 0, k_accelerate});
  for (int i = 0; i < 6; ++i) world.step();
  EXPECT_NEAR(robot.velocity(world).x, 0.3, 1e-12);
}

/// Where a robot is after so many seconds of going to a goal.
Pose gone_to(const std::string& kind, const Pose& from, const Pose& goal, int seconds, double period_s = 0) {
  Robot robot(kind, {{"wheelbase", 0.5}}, period_s);
  robot.scene.spec.bodies.back().pose_world_body = from;
  engine::World world = robot.scene.world();
  world.set_command(world.view().row(robot.body), {goal.x, goal.y, goal.heading, k_go_to});
  for (int i = 0; i < 10 * seconds; ++i) world.step();
  return world.view().pose(robot.body);
}

TEST(Drives, EachGoesToItsGoalAndStaysThere) {
  for (const char* kind : {"diff", "omni", "car"})
    for (const Pose& from :
         {Pose{0, 0, 0, 0}, Pose{3, 1, 0, 3}, Pose{1.4, -2.2, 0, -1}, Pose{-2, -6, 0, 2.9}})
      for (const double period_s : {0.0, 0.5, 3.0}) {
        const Pose goal{1.5, -2, 0, 2};
        const Pose at = gone_to(kind, from, goal, 90, period_s);
        EXPECT_NEAR(at.x, goal.x, 0.02) << kind << " from " << from.x << ", every " << period_s;
        EXPECT_NEAR(at.y, goal.y, 0.02) << kind << " from " << from.x << ", every " << period_s;
        EXPECT_NEAR(at.heading, goal.heading, 0.01) << kind << " from " << from.x << ", every " << period_s;
      }
}

TEST(Drives, DiffTurnsBothWaysNoFasterThanItMay) {
  // Stage loses the upper limit: to the left it turns by all that is missing a second.
  for (const double side : {1.0, -1.0}) {
    Robot robot("diff");
    engine::World world = robot.scene.world();
    world.set_command(world.view().row(robot.body), {-1, side * 0.5, 0, k_go_to});
    world.step();
    EXPECT_EQ(robot.velocity(world).turn, side);
    EXPECT_EQ(robot.velocity(world).x, 0);
  }
  // Ahead it drives, 0.4 m/s at most, and slows down before the goal.
  Robot robot("diff");
  engine::World world = robot.scene.world();
  world.set_command(world.view().row(robot.body), {3, 0, 0, k_go_to});
  world.step();
  EXPECT_EQ(robot.velocity(world).x, 0.4);
  world.set_command(world.view().row(robot.body), {world.view().pose(robot.body).x + 0.1, 0, 0, k_go_to});
  world.step();
  EXPECT_NEAR(robot.velocity(world).x, 0.1, 1e-12);
}

TEST(Drives, OmniGoesStraightWhateverItsHeading) {
  // Stage takes the way in the world for one in the body's frame, and has no lower limits.
  Robot robot("omni");
  robot.scene.spec.bodies.back().pose_world_body.heading = k_pi / 2;
  engine::World world = robot.scene.world();
  world.set_command(world.view().row(robot.body), {2, -0.2, k_pi / 2, k_go_to});
  world.step();
  EXPECT_NEAR(robot.velocity(world).x, -0.2, 1e-12);
  EXPECT_NEAR(robot.velocity(world).y, -0.4, 1e-12);
  EXPECT_NEAR(robot.velocity(world).turn, 0, 1e-12);
  EXPECT_NEAR(world.view().pose(robot.body).x, 0.04, 1e-12);
}

TEST(Drives, ACarDrivesInACurveAndSwingsRoundToWhatLiesBehind) {
  Robot robot("car", {{"wheelbase", 0.5}});
  engine::World world = robot.scene.world();
  const Row row = world.view().row(robot.body);
  world.set_command(row, {1, 0.5, 0, k_go_to});
  world.step();
  const double off = std::atan2(0.5, 1);
  EXPECT_NEAR(robot.velocity(world).x, 0.4 * std::cos(off), 1e-9);
  EXPECT_NEAR(robot.velocity(world).turn, 2 * off, 1e-9);
  world.set_command(row, {-1, 0.5, 0, k_go_to});
  world.step();
  EXPECT_EQ(robot.velocity(world).x, 0);
  EXPECT_EQ(robot.velocity(world).turn, 1);
}

TEST(Drives, GoalsAreBoundedByTheDrive) {
  Robot robot("diff", {{"velocity_max_x", 0.3}, {"turn_max", 0.2}});
  engine::World world = robot.scene.world();
  const Row row = world.view().row(robot.body);
  world.set_command(row, {5, 0, 0, k_go_to});
  world.step();
  EXPECT_EQ(robot.velocity(world).x, 0.3);
  world.set_command(row, {0, 5, 0, k_go_to});
  world.step();
  EXPECT_EQ(robot.velocity(world).turn, 0.2);
}

TEST(Drives, TheStartingVelocityLastsUntilTheFirstUpdate) {
  // Updates every 0.3 s: it acts in the first two ticks. With one every tick it never does.
  for (const auto& [period_s, way] : {std::pair(0.3, 0.4), std::pair(0.0, 0.0)}) {
    Robot robot("omni", {{"start_x", 2.0}, {"start_y", 0.5}, {"start_turn", 0.0}}, period_s);
    engine::World world = robot.scene.world();
    EXPECT_EQ(robot.velocity(world).x, 2.0);
    for (int i = 0; i < 5; ++i) world.step();
    EXPECT_NEAR(world.view().pose(robot.body).x, way, 1e-12);
    EXPECT_NEAR(world.view().pose(robot.body).y, way / 4, 1e-12);
    world.reset();
    EXPECT_EQ(robot.velocity(world).x, 2.0);
  }
}

TEST(Drives, BoundsOfAccelerationsMustNotStandTheWrongWayRound) {
  for (const auto& [low, high] : {std::pair("acceleration_min_x", "acceleration_max_x"),
                                  std::pair("acceleration_min_y", "acceleration_max_y"),
                                  std::pair("turn_acceleration_min", "turn_acceleration_max")}) {
    const engine::DriveSpec spec = test::drive("car", {{low, 2.0}, {high, 1.0}});
    EXPECT_EQ(car_drive().check(spec.params).error().text,
              std::string(low) + ", " + high + ": lower bound 2 exceeds upper bound 1");
  }
}

TEST(Drives, HeadingStaysWithinPi) {
  Robot robot("diff");
  engine::World world = robot.scene.world();
  world.set_command(world.view().row(robot.body), {0, 0, 1.5});
  for (int i = 0; i < 500; ++i) {
    world.step();
    ASSERT_LE(std::abs(world.view().pose(robot.body).heading), k_pi);
  }
}

}  // namespace
}  // namespace troupe::models::drives_test
