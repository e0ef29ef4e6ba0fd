#include "engine/kinds/localization.hpp"

#include "engine/observing/controller_check.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/result.hpp"
#include "tests/support/scene.hpp"
#include "troupe/simulation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace troupe::engine::localization_test {
namespace {

using Params = std::initializer_list<std::pair<std::string_view, Value>>;

const std::vector<double> k_no_error{0, 0, 0};

/// A robot of 0.4 m at (x, y), in a world of its own.
struct Robot {
  Robot(const std::string& kind, Params params, Pose at = {}) {
    const TypeId type = scene.robot("robot", {Solid{{test::box_ring(0.4, 0.4)}, {0, 1}}}, kind);
    scene[type].drive = test::drive(kind, params);
    body = scene.body("r", type, at);
  }
  test::SceneBuilder scene;
  BodyId body;
};

void expect_pose(const Pose& pose, double x, double y, double heading, double within = 5e-7) {
  EXPECT_NEAR(pose.x, x, within);
  EXPECT_NEAR(pose.y, y, within);
  EXPECT_NEAR(pose.heading, heading, within);
}

TEST(Conformance02, OdometryOfADiffDriveWithErrors) {
  // odom_error [0.1 0.2 0 0.3] in a file of degrees: the last acts as 0.3 pi / 180.
  Robot robot("diff", {{"localization", "odom"},
                       {"odom_error", std::vector<double>{0.1, 0.2, radians(0.3)}},
                       {"odom_heading", "new"}});
  World world = robot.scene.world();
  const Row row = world.view().row(robot.body);
  world.set_command(row, {0.5, 0, 1});
  world.step();
  expect_pose(world.view().estimate(row), 0.054722, 0.005519, 0.100524);
  while (world.tick() < 15) world.step();
  expect_pose(world.view().estimate(row), 0.519822, 0.539734, 1.507854);
}

TEST(Conformance02, LaidAlongTheOldHeadingOnlyTheErrorIsWrong) {
  Robot robot("diff",
              {{"localization", "odom"}, {"odom_error", std::vector<double>{0.1, 0.2, radians(0.3)}}});
  World world = robot.scene.world();
  const Row row = world.view().row(robot.body);
  world.set_command(row, {0.5, 0, 1});
  world.step();
  expect_pose(world.view().estimate(row), 0.05 * 1.1, 0, 0.1 * (1 + radians(0.3)), 1e-12);
}

TEST(Conformance03, OdometryOfAnOmniDriveHasItsLateralTermTheRightWayRound) {
  // Stage: (0.052745, -0.024858). Its formula with the sign put right:
  Robot stage("omni", {{"localization", "odom"}, {"odom_error", k_no_error}, {"odom_heading", "new"}});
  World world = stage.scene.world();
  const Row row = world.view().row(stage.body);
  world.set_command(row, {0.5, 0.3, 1});
  world.step();
  expect_pose(world.view().pose(stage.body), 0.05, 0.03, 0.1, 1e-12);
  expect_pose(world.view().estimate(row), 0.05 * std::cos(0.1) - 0.03 * std::sin(0.1),
              0.05 * std::sin(0.1) + 0.03 * std::cos(0.1), 0.1, 1e-12);
  // The wrong sign is the mirror image of this, across the way forward.
  EXPECT_NEAR(0.05 * std::cos(0.1) + 0.03 * std::sin(0.1), 0.052745, 5e-7);
  EXPECT_NEAR(0.05 * std::sin(0.1) - 0.03 * std::cos(0.1), -0.024858, 5e-7);
  // Along the old heading it is the truth.
  Robot ours("omni", {{"localization", "odom"}, {"odom_error", k_no_error}});
  World true_world = ours.scene.world();
  const Row true_row = true_world.view().row(ours.body);
  true_world.set_command(true_row, {0.5, 0.3, 1});
  true_world.step();
  expect_pose(true_world.view().estimate(true_row), 0.05, 0.03, 0.1, 1e-12);
}

TEST(Localization, WithoutErrorOdometryIsTheTruthInTheFrameOfTheStart) {
  Robot robot("omni", {{"localization", "odom"}, {"odom_error", k_no_error}}, {3, -1, 0.5, 2});
  World world = robot.scene.world();
  const Row row = world.view().row(robot.body);
  expect_pose(world.view().estimate(row), 0, 0, 0, 0);
  for (int i = 0; i < 100; ++i) {
    world.set_command(row, {0.1 * (i % 7), 0.1 * (i % 5) - 0.2, 0.4 * (i % 3) - 0.3});
    world.step();
    const Pose truth = relative_to({3, -1, 0, 2}, world.view().pose(robot.body));
    expect_pose(world.view().estimate(row), truth.x, truth.y, truth.heading, 1e-9);
    EXPECT_EQ(world.view().estimate(row).z, 0.5);
  }
}

TEST(Localization, OdometryStandsStillWithARobotThatIsStalled) {
  Robot robot("diff", {{"localization", "odom"}, {"odom_error", k_no_error}});
  robot.scene.wall(0.5, -1, 1, 1);
  World world = robot.scene.world();
  const Row row = world.view().row(robot.body);
  world.set_command(row, {0.9, 0, 0});
  for (int i = 0; i < 10; ++i) world.step();
  ASSERT_TRUE(world.view().stalled(row));
  expect_pose(world.view().estimate(row), world.view().pose(robot.body).x, 0, 0, 1e-12);
  EXPECT_NEAR(world.view().estimate(row).x, 0.27, 1e-12);
}

TEST(Localization, OdometryMissesNoTickBetweenUpdates) {
  Robot robot("diff", {{"localization", "odom"}, {"odom_error", k_no_error}});
  robot.scene[TypeId(1)].drive->period_s = 0.3;
  World world = robot.scene.world();
  const Row row = world.view().row(robot.body);
  world.set_command(row, {0.5, 0, 0});
  for (int i = 0; i < 8; ++i) world.step();
  EXPECT_NEAR(world.view().pose(robot.body).x, 0.3, 1e-12);  // from the third tick on
  EXPECT_NEAR(world.view().estimate(row).x, 0.3, 1e-12);
}

TEST(Localization, OriginsAreFramesOfTheWorld) {
  const Params origin{{"localization_origin", std::vector<double>{1, 2}},
                      {"localization_origin_heading", k_pi / 2}};
  for (const char* kind : {"gps", "odom"}) {
    Robot robot("diff", origin, {3, 4, 0, 0});
    robot.scene[TypeId(1)].drive->params[static_cast<std::size_t>(
        test::registry().drive("diff")->params.find("localization"))] = kind;
    const World world = robot.scene.world();
    expect_pose(world.view().estimate(world.view().row(robot.body)), 2, -2, -k_pi / 2, 1e-12);
  }
  Robot gps("diff", {}, {3, 4, 0, 0.25});
  const World world = gps.scene.world();
  expect_pose(world.view().estimate(world.view().row(gps.body)), 3, 4, 0.25, 0);
}

TEST(Localization, ErrorsAreDrawnForEachRobotFromTheSeed) {
  Localization how{.kind = Localization::Kind::odom};
  double least = 1;
  double most = -1;
  double sum = 0;
  for (std::uint32_t id = 1; id <= 2000; ++id) {
    const Localization::Error error = how.error_of(7, BodyId(id));
    EXPECT_EQ(error.x, how.error_of(7, BodyId(id)).x);
    EXPECT_NE(error.x, how.error_of(8, BodyId(id)).x);
    EXPECT_LE(std::abs(error.x), 0.015);
    EXPECT_LE(std::abs(error.y), 0.015);
    EXPECT_LE(std::abs(error.turn), 0.025);
    least = std::min(least, error.turn);
    most = std::max(most, error.turn);
    sum += error.x;
  }
  EXPECT_LT(least, -0.0249);
  EXPECT_GT(most, 0.0249);
  EXPECT_NEAR(sum / 2000, 0, 0.0008);  // four standard deviations of the mean
  how.error = {1, 2, 3};
  EXPECT_EQ(how.error_of(7, BodyId(5)).turn, 3);
}

TEST(Localization, OnlyRobotsWithOdometryHaveSuchAState) {
  Robot robot("diff", {});
  const World world = robot.scene.world();
  for (const StateTable& table : world.tables()) EXPECT_NE(table.component(), "odometry");
  Robot counting("diff", {{"localization", "odom"}});
  World with = counting.scene.world();
  const Row row = with.view().row(counting.body);
  const auto table = std::ranges::find(with.tables(), "odometry", &StateTable::component);
  ASSERT_NE(table, with.tables().end());
  const std::uint64_t before = hash_rows(with.parallel(), *table, {0, table->rows()});
  with.set_command(row, {0.5, 0, 0});
  with.step();
  EXPECT_NE(hash_rows(with.parallel(), *table, {0, table->rows()}), before);
  with.reset();
  EXPECT_EQ(hash_rows(with.parallel(), *table, {0, table->rows()}), before);
  with.set_estimate(row, {5, 6, 0, 7});
  expect_pose(with.view().estimate(row), 5, 6, 7 - 2 * k_pi, 1e-12);
}

// Larger numbers could make an estimate infinite, and then NaN, without an error.
TEST(Localization, TheErrorsAndTheOriginAreLimited) {
  const auto load = [](const char* name, std::vector<double> numbers) {
    const Robot robot("diff", {{"localization", "odom"}, {name, std::move(numbers)}});
    Simulation simulation(robot.scene.spec);
  };
  EXPECT_NO_THROW(load("odom_error", {1000, 0, -1000}));
  EXPECT_NO_THROW(load("localization_origin", {-1e9, 1e9}));
  EXPECT_THROW(load("odom_error", {1001, 0, 0}), InputError);
  EXPECT_THROW(load("odom_error", {0, 0, -1001}), InputError);
  EXPECT_THROW(load("localization_origin", {0, 1.1e9}), InputError);
}

TEST(Localization, AnEstimateThatBecomesInfiniteIsAnError) {
  Robot robot(
      "diff",
      {{"localization", "odom"}, {"odom_error", std::vector<double>{0, 0, 1000}}, {"turn_max", 1e308}});
  World world = robot.scene.world();
  world.set_command(world.view().row(robot.body), {0, 0, 1e306});  // 1e305 rad in a tick, times 1001
  world.step();
  EXPECT_TRUE(std::isfinite(world.view().estimate(world.view().row(robot.body)).heading));
  world.set_command(world.view().row(robot.body), {0, 0, 1e307});
  EXPECT_EQ(test::message_of<StepError>([&] { world.step(); }),
            "tick 2: the odometry of robot \"r\" computed a heading that is not a finite number, from a turn "
            "of 1e+306 rad in a tick and the error of the turn in `odom_error`");
}

TEST(Localization, AWrongNumberOfNumbersIsAnError) {
  const auto check = [&](Params params) {
    const Record record = test::record(described<LocalizationParams>(), params);
    const Result<Localization> how = from_record<LocalizationParams>(record).read();
    return how ? std::string() : how.error().text;
  };
  EXPECT_EQ(check({{"odom_error", std::vector<double>{1, 2}}}),
            "odom_error must have three numbers, [forward, left, turn], or none, found 2");
  EXPECT_EQ(check({{"localization_origin", std::vector<double>{1}}}),
            "localization_origin must have two numbers, [x, y], or none, found 1");
  EXPECT_EQ(check({}), "");
  Robot robot("diff", {{"odom_error", std::vector<double>{1}}});
  Diagnostics diagnostics;
  EXPECT_THROW(World(robot.scene.spec, test::registry(), {}, diagnostics), InputError);
}

}  // namespace
}  // namespace troupe::engine::localization_test
