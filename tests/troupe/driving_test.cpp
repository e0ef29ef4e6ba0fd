// Robots that drive to goals, accelerate, are moved by the program, and have wrong estimated poses.

#include "engine/world/world.hpp"
#include "tests/support/hash_log.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/recording.hpp"
#include "troupe/troupe.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace troupe::driving_test {
namespace {

namespace fs = std::filesystem;

const fs::path k_errands = test::source_dir() / "worlds" / "errands.json";

class Driving : public test::ScratchTest {
 protected:
  /// A robot of each drive, 3 m apart, and a wall across the way of the first.
  fs::path world(const std::string& drive = "") {
    return write("drives.world",
                 "position( name \"diff\" size [0.4 0.4 0.4] " + drive +
                     " )\n"
                     "position( name \"omni\" drive \"omni\" pose [0 3 0 90] size [0.4 0.4 0.4] )\n"
                     "position( name \"car\" drive \"car\" wheelbase 0.5 pose [0 6 0 0] "
                     "size [0.4 0.4 0.4] )\n"
                     "model( name \"wall\" pose [2 0 0 0] size [0.2 2 1] )\n");
  }
};

TEST_F(Driving, RobotsGoWhereTheyAreSentAndStayThere) {
  Simulation simulation(world());
  const Pose goals[]{{-1, -2, 0, 1}, {2, 5, 0, -3}, {-3, 7, 0, 0.5}};
  const char* names[]{"diff", "omni", "car"};
  for (int i = 0; i < 3; ++i) simulation.find(names[i]).go_to(goals[i]);
  simulation.run_for(40);
  for (int i = 0; i < 3; ++i) {
    const Pose at = simulation.find(names[i]).pose();
    EXPECT_NEAR(at.x, goals[i].x, 0.02) << names[i];
    EXPECT_NEAR(at.y, goals[i].y, 0.02) << names[i];
    EXPECT_NEAR(at.heading, goals[i].heading, 0.01) << names[i];
  }
  // A speed ends it.
  simulation.find("diff").set_speed(0, 0.5);
  simulation.step();
  EXPECT_EQ(simulation.find("diff").speed().turn, 0.5);
}

TEST_F(Driving, ANumberOfOneModeIsNoNumberOfAnother) {
  // The same three numbers mean a speed, an acceleration and a goal: the state tells them apart.
  std::vector<std::uint64_t> hashes;
  for (int mode = 0; mode < 3; ++mode) {
    Simulation simulation(world());
    Model robot = simulation.find("diff");
    if (mode == 0) robot.set_speed(0.5, 0, 0.25);
    if (mode == 1) robot.accelerate(0.5, 0, 0.25);
    if (mode == 2) robot.go_to(0.5, 0, 0.25);
    hashes.push_back(simulation.state_hash());
    simulation.step();
    EXPECT_NEAR(robot.speed().forward, mode == 0 ? 0.5 : mode == 1 ? 0.05 : 0.4, 1e-12);
  }
  EXPECT_NE(hashes[0], hashes[1]);
  EXPECT_NE(hashes[1], hashes[2]);
  EXPECT_NE(hashes[0], hashes[2]);
}

TEST_F(Driving, AWallStallsWhoAcceleratesAndHisOdometry) {
  Simulation simulation(world("localization \"odom\" odom_error [0 0 0 0]"));
  Model robot = simulation.find("diff");
  robot.accelerate(0.5, 0);
  simulation.run_for(6);
  EXPECT_TRUE(robot.stalled());
  EXPECT_LE(robot.pose().x, 1.7);
  EXPECT_GT(robot.pose().x, 1.55);
  EXPECT_NEAR(robot.estimate().x, robot.pose().x, 1e-12);
  EXPECT_EQ(robot.speed().forward, 1);  // as fast as it may be, as in Stage
}

TEST_F(Driving, WhatStageWorldsSayOfOriginsHolds) {
  Simulation gps(world("pose [3 4 0 0] localization_origin [1 1 0 0]"));
  EXPECT_EQ(gps.find("diff").estimate().x, 3);  // as Stage does
  EXPECT_THAT(gps.warnings(),
              ::testing::Contains(::testing::HasSubstr("add \"gps_origin 1\" to apply the origin")));
  Simulation honoured(world("pose [3 4 0 0] localization_origin [1 1 0 0] gps_origin 1"));
  EXPECT_EQ(honoured.find("diff").estimate().x, 2);
  Simulation odom(world("pose [3 4 0 0] localization_origin [1 1 0 0] localization \"odom\""));
  EXPECT_EQ(odom.find("diff").estimate().y, 3);
  Model robot = odom.find("diff");
  robot.set_estimate({9, 9, 0, 0});
  EXPECT_EQ(robot.estimate().x, 9);
  EXPECT_THROW(gps.find("diff").set_estimate({9, 9, 0, 0}), std::logic_error);
}

TEST_F(Driving, StartingVelocitiesActUntilTheFirstUpdate) {
  Simulation never(world("velocity [1 0 0 0]"));
  never.run_for(1);
  EXPECT_EQ(never.find("diff").pose().x, 0);
  Simulation twice(world("velocity [1 0 0 270] update_interval 300"));
  EXPECT_NEAR(twice.find("diff").speed().turn, 1.5 * k_pi, 1e-12);  // a rate does not wrap
  twice.run_for(1);
  EXPECT_NEAR(twice.find("diff").pose().heading, 0.3 * k_pi, 1e-12);
}

TEST_F(Driving, RobotsArePutElsewhereOneByOneOrAllAtOnce) {
  Simulation simulation(world());
  Model diff = simulation.find("diff");
  EXPECT_TRUE(diff.is_free({-3, -3, 0, 0}));
  EXPECT_FALSE(diff.is_free({2, 0.5, 0, 0}));
  EXPECT_FALSE(diff.is_free({0.1, 3, 0, 0}));
  diff.set_pose({-3, -3, 0, 1});
  EXPECT_EQ(diff.pose().x, -3);
  EXPECT_TRUE(simulation.find("omni").is_free({0, 0, 0, 0}));
  const std::pair<Model, Pose> both[]{{diff, {0, 3, 0, 0}}, {simulation.find("omni"), {-3, -3, 0, 0}}};
  simulation.set_poses(both);
  EXPECT_FALSE(simulation.find("car").is_free({0, 3, 0, 0}));
  EXPECT_THROW(simulation.find("wall").set_pose({}), std::logic_error);
  EXPECT_THROW(diff.set_pose({std::nan(""), 0, 0, 0}), std::invalid_argument);
  Simulation other(world());
  const std::pair<Model, Pose> foreign[]{{other.find("diff"), {5, 5, 0, 0}}};
  EXPECT_THROW(simulation.set_poses(foreign), std::logic_error);
}

TEST_F(Driving, WherePutDependsOnNeitherThreadsNorTiles) {
  std::vector<std::string> first;
  for (const auto& [threads, tile_m] : {std::pair(1u, 0.0), std::pair(3u, 1.7), std::pair(2u, 20.0)}) {
    Simulation simulation(k_errands, {.threads = threads, .tile_size_m = tile_m});
    std::vector<std::string> lines = test::hash_log(simulation, 3);
    std::vector<std::pair<Model, Pose>> poses;
    const std::vector<std::string> names = simulation.robot_names();
    for (std::size_t i = 0; i < names.size(); i += 3)  // some of them into others
      poses.emplace_back(simulation.find(names[i]), Pose{0.3 * static_cast<double>(i) - 3, 0.1, 0, 0.7});
    simulation.set_poses(poses);
    for (const std::string& line : test::hash_log(simulation, 20)) lines.push_back(line);
    if (first.empty()) first = lines;
    EXPECT_EQ(lines, first) << threads << " threads, tiles of " << tile_m;
  }
}

TEST_F(Driving, ErrandsEndWhereTheOdometryOfEachBelieves) {
  // Both go on until their wheels have counted 2 m. The dreamer's count a quarter too much.
  Simulation simulation(k_errands);
  const Model surveyor = simulation.find("surveyor");
  const Model dreamer = simulation.find("dreamer");
  simulation.run_for(test::k_slow_build ? 14 : 30);
  EXPECT_NEAR(surveyor.pose().x, -1 + 2, 0.021);
  EXPECT_NEAR(dreamer.pose().x, -1 + 1.6, 0.021);
  EXPECT_NEAR(dreamer.estimate().x, 2, 0.021);
}

TEST_F(Driving, ACheckpointKeepsModesAndBeliefs) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  const auto send = [](Simulation& simulation) {
    simulation.find("diff").go_to(-1, -2, 1);
    simulation.find("omni").accelerate(0.1, 0.2, -0.1);
    simulation.find("car").set_speed(0.4, 0.1);
  };
  Simulation straight(world("localization \"odom\""));
  send(straight);
  straight.run_for(1);
  straight.save(folder_ / "run.h5");
  Simulation resumed = Simulation::resume(folder_ / "run.h5");
  EXPECT_EQ(test::hash_log(resumed, 20), test::hash_log(straight, 20));
}

TEST_F(Driving, ARecordingTellsTheModeOfACommand) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  Simulation simulation(world());
  {
    Recording recording(folder_ / "run.h5", simulation, {.fields = {"command"}});
    recording.observe(simulation);
    simulation.find("omni").go_to(1, 2, 3);
    simulation.step();
    recording.observe(simulation);
    recording.close();
  }
  const worldio::Hdf5File file = worldio::Hdf5File::open(folder_ / "run.h5");
  const auto modes = file.group("state").group("command").dataset("mode").read<std::uint8_t>();
  EXPECT_THAT(modes, ::testing::ElementsAre(0, 0, 0, 0, 2, 0));
}

}  // namespace
}  // namespace troupe::driving_test
