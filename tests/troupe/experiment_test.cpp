// Experiments in programs and files: worlds/door.json, worlds/failures.json and the C++ interface.

#include "engine/world/world.hpp"
#include "tests/support/hash_log.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/troupe.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::experiment_test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const fs::path k_worlds = test::source_dir() / "worlds";

void step(Simulation& simulation, int ticks) {
  for (int tick = 0; tick < ticks; ++tick) simulation.step();
}

TEST(Interventions, ThatAddMoreThanTheReserveHasAreWarnedOf) {
  const auto warnings = [](const std::string& at) {
    return Simulation::from_text(R"({"troupe": 1, "bounds_m": [[-2, -2], [2, 2]],
        "types": {"bot": {"size_m": [0.1, 0.1, 0.1], "drive": {"kind": "diff"}}},
        "populations": [{"name": "r", "type": "bot", "count": 1, "reserve": 3, "place": {"rule": "uniform"}}],
        "at": [)" + at + "]}",
                                 "w.json")
        .warnings();
  };
  const std::string two = R"({"time_s": 1, "add": {"population": "r", "count": 2}})";
  const std::string all = R"({"time_s": 2, "add": {"population": "r"}})";
  EXPECT_THAT(warnings(two), IsEmpty());
  EXPECT_THAT(warnings(two + "," + all), IsEmpty());
  EXPECT_THAT(
      warnings(two + "," + two + "," + two),
      ElementsAre(HasSubstr("w.json:4: warning: at 1 s: 2 bodies are to be added to \"r\", but at most 1 "
                            "are left in its \"reserve\": enlarge the reserve")));
  EXPECT_THAT(warnings(all + "," + two), IsEmpty()) << "the second entry is applied first";
  const std::string late = R"({"time_s": 3, "add": {"population": "r", "count": 2}})";
  EXPECT_THAT(warnings(late + "," + all),
              ElementsAre(HasSubstr("at 3 s: 2 bodies are to be added to \"r\", but at most 0 are left")));
}

TEST(DoorScene, TheDoorOpensInTimeAndWhoWaitedGoesThrough) {
  Simulation simulation(k_worlds / "door.json", {.threads = 2});
  const Model door = simulation.find("door");
  const Model scout = simulation.find("scout");
  step(simulation, 200);
  EXPECT_EQ(door.pose().y, 0) << "at 20 s";
  // From x = -4 at 0.5 m/s, a tick after its first command, to its front at the door's face, x = -0.1.
  EXPECT_NEAR(scout.pose().x, -0.2, 0.05);
  EXPECT_LE(scout.pose().x, -0.2 + 1e-9);
  EXPECT_TRUE(scout.stalled());
  step(simulation, 20);
  EXPECT_NEAR(door.pose().y, 1.1, 1e-9) << "2.2 m in 4 s";
  step(simulation, 20);
  EXPECT_NEAR(door.pose().y, 2.2, 1e-9);
  // The scout's lane is y = -0.8: its upper side, y = -0.7, is free when the door's lower one is above that,
  // 0.3 m from where it was, at 20.55 s: in tick 206.
  step(simulation, 10);
  EXPECT_NEAR(scout.pose().x, -0.2 + 0.05 * (250 - 206), 0.1);
  EXPECT_FALSE(scout.stalled());
}

TEST(DoorScene, WalkersKeepToTheirRounds) {
  Simulation simulation(k_worlds / "door.json", {.threads = 1});
  const Model guard = simulation.find("guard");
  step(simulation, 40);
  EXPECT_NEAR(guard.pose().y, 0, 1e-9) << "half-way at 4 s";
  const Pose first = guard.pose();
  step(simulation, 120);
  EXPECT_NEAR(guard.pose().y, first.y, 1e-9) << "a round of 12 s later";
  EXPECT_NEAR(guard.pose().x, first.x, 1e-9);
}

TEST(FailuresScene, AThirdDiesAndTheOthersStillCoverTheGround) {
  if (test::k_slow_build) GTEST_SKIP() << "it takes minutes";
  Simulation simulation(k_worlds / "failures.json", {.threads = 2});
  step(simulation, 200);
  EXPECT_EQ(simulation.robots(), 61u) << "with the crate, which a drive could move";
  simulation.step();
  EXPECT_EQ(simulation.robots(), 41u) << "0.333 of 60 is 19.98";
  simulation.run_for(600);
  ASSERT_TRUE(simulation.stopped());
  EXPECT_EQ(*simulation.stopped(), "covered >= 0.9");
  const double end_s = simulation.time_s();
  EXPECT_GT(end_s, 20.1) << "not before they died";

  SimulationOptions options{.threads = 2};
  options.set = {{"/at", "[]"}, {"/faults", "[]"}};
  Simulation sound(k_worlds / "failures.json", options);
  sound.run_for(600);
  ASSERT_TRUE(sound.stopped());
  EXPECT_LT(sound.time_s(), end_s) << "more of them are faster";
}

class ExperimentScenes : public test::ScratchTest, public ::testing::WithParamInterface<scenes::Run> {};

constexpr int k_ticks = test::k_slow_build ? 30 : 260;

TEST_P(ExperimentScenes, DependOnNeitherThreadsNorTilesAndComeAgain) {
  Simulation first(GetParam().file(), {.threads = 1});
  const std::vector<std::string> expected = test::hash_log(first, k_ticks);
  for (const auto& [threads, tile_m] : {std::pair(2u, 0.7), std::pair(8u, 20.0)}) {
    Simulation simulation(GetParam().file(), {.threads = threads, .tile_size_m = tile_m});
    EXPECT_EQ(test::hash_log(simulation, k_ticks), expected) << threads << " threads";
  }
  first.reset();
  EXPECT_EQ(test::hash_log(first, k_ticks), expected) << "after a reset";
}

TEST_P(ExperimentScenes, GoOnFromTheMiddleOfThem) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  const int before = test::k_slow_build ? 22 : 205;
  Simulation straight(GetParam().file(), {.threads = 1});
  step(straight, before);
  straight.save(folder_ / "run.h5");
  const std::vector<std::string> expected = test::hash_log(straight, k_ticks - before);
  Simulation resumed = Simulation::resume(folder_ / "run.h5", {.threads = 3, .tile_size_m = 1.7});
  EXPECT_EQ(test::hash_log(resumed, k_ticks - before), expected);
}

INSTANTIATE_TEST_SUITE_P(Shipped, ExperimentScenes, ::testing::ValuesIn(scenes::runs_of("experiments")),
                         [](const auto& run) { return run.param.name(); });

// A list that a controller's memory points into may become shorter while the world runs.

/// A number of a controller's memory, of each robot that has such a controller.
std::vector<int> remembered(const Simulation& simulation, std::string_view component,
                            std::string_view field) {
  std::vector<int> values;
  for (const engine::StateTable& table : simulation.world().tables()) {
    if (table.component() != component) continue;
    for (std::size_t f = 0; f < table.fields().size(); ++f) {
      if (table.fields()[f].name != field) continue;
      for (std::size_t row = 0; row < table.rows(); ++row)
        values.push_back(table.fields()[f].element == engine::Element::u8
                             ? static_cast<int>(table.cell<std::uint8_t>(row, f)[0])
                             : static_cast<int>(table.cell<std::uint32_t>(row, f)[0]));
    }
  }
  return values;
}

TEST(SetOfFewer, GoalsSendARobotToTheLastOfThem) {
  Simulation simulation = Simulation::from_text(R"({"troupe": 1, "types": {"r": {"size_m": [0.2, 0.2, 0.2],
      "drive": {"kind": "omni"}, "controller": {"kind": "waypoints", "goals": [{}, {}, {"x_m": -3}]}}},
    "models": [{"name": "r", "type": "r"}],
    "at": [{"time_s": 1, "set": {"type": "r", "controller": {"kind": "waypoints", "goals": [{"x_m": 2}]}}}]})",
                                                "fewer.json");
  step(simulation, 10);
  EXPECT_EQ(remembered(simulation, "waypoints/0", "goal"), std::vector<int>{2});
  step(simulation, 140);
  EXPECT_EQ(remembered(simulation, "waypoints/0", "goal"), std::vector<int>{0});
  EXPECT_NEAR(simulation.find("r").pose().x, 2, 0.1);
}

constexpr std::string_view k_depot = R"({"size_m": [0.5, 0.5, 0.01], "obstacle": false, "ranger_return": -1,
  "devices": [{"name": "flags", "kind": "flags"}]})";

TEST(SetOfFewer, TasksAreDrawnAmongThem) {
  Simulation simulation = Simulation::from_text(fmt::format(R"({{"troupe": 1, "types": {{"depot": {},
      "r": {{"size_m": [0.2, 0.2, 0.2], "drive": {{"kind": "diff"}},
        "sensors": [{{"kind": "ranger", "transducers": [{{"samples": 9}}]}}], "devices": [{{"kind": "flags"}}],
        "controller": {{"kind": "fasr2", "task": "red", "task2": "green"}}}}}},
    "models": [{{"name": "red_source", "type": "depot", "pose": {{"x_m": 5}}}},
      {{"name": "red_sink", "type": "depot", "pose": {{"x_m": -5}}}},
      {{"name": "green_source", "type": "depot", "pose": {{"y_m": 5}}}},
      {{"name": "green_sink", "type": "depot", "pose": {{"y_m": -5}}}}],
    "populations": [{{"name": "r", "type": "r", "count": 16,
      "place": {{"rule": "grid", "region_m": [[-2, -2], [2, 2]], "pitch_m": 1}}}}],
    "at": [{{"time_s": 0.5, "set": {{"type": "r", "controller": {{"kind": "fasr2", "task2": ""}}}}}}]}})",
                                                            k_depot),
                                                "fewer.json");
  step(simulation, 5);
  EXPECT_THAT(remembered(simulation, "fasr2/0", "task"), ::testing::Contains(1)) << "of two tasks";
  step(simulation, 1);
  EXPECT_THAT(remembered(simulation, "fasr2/0", "task"), ::testing::Each(0)) << "of one";
}

TEST(SetOfFewer, ACollectorLeavesAChargerThatIsNoneAnyMore) {
  Simulation simulation = Simulation::from_text(fmt::format(R"({{"troupe": 1, "types": {{"depot": {},
      "pad": {{"size_m": [0.5, 0.5, 0.01], "obstacle": false, "ranger_return": -1, "fiducial_return": 2}},
      "r": {{"size_m": [0.2, 0.2, 0.2], "drive": {{"kind": "diff"}},
        "sensors": [{{"kind": "ranger", "transducers": [{{"samples": 9}}]}}, {{"kind": "fiducial"}}],
        "devices": [{{"kind": "gripper", "pose": {{"x_m": 0.2}}}},
                    {{"kind": "power_pack", "capacity_J": 1000, "stored_J": 100}}],
        "controller": {{"kind": "collector"}}}}}},
    "models": [{{"name": "sink", "type": "depot", "pose": {{"x_m": -5}}}},
      {{"name": "pad", "type": "pad", "pose": {{"x_m": 5}}}}, {{"name": "r", "type": "r"}}],
    "at": [{{"time_s": 0.5, "set": {{"type": "r", "controller": {{"kind": "collector", "charger": 9}}}}}}]}})",
                                                            k_depot),
                                                "fewer.json");
  constexpr int k_leaving = 4, k_charging = 5;  // models/controllers/collector.cpp
  step(simulation, 5);
  EXPECT_EQ(remembered(simulation, "collector/0", "mode"), std::vector<int>{k_charging});
  step(simulation, 1);
  EXPECT_EQ(remembered(simulation, "collector/0", "mode"), std::vector<int>{k_leaving});
}

class StopWhen : public test::ScratchTest {
 protected:
  /// A robot that drives 1 m/s along x, from x = 0; the first motion is that of tick 2.
  fs::path world(const std::string& keys) const {
    return write("w.json", fmt::format(R"({{"troupe": 1, "bounds_m": [[-1, -1], [20, 1]], "quit_time_s": 100,
      "types": {{"bot": {{"size_m": [0.4, 0.4, 0.4], "drive": {{"kind": "diff"}},
        "controller": {{"kind": "script", "legs": [{{"until_s": 1000, "forward_mps": 1}}]}}}}}},
      "models": [{{"name": "r", "type": "bot"}}], {}}})",
                                       keys));
  }
};

TEST_F(StopWhen, TheRunIsOverWithTheFirstTickAfterWhichOneHolds) {
  Simulation simulation(world(R"("stop_when": ["displacement >= 5.01", "alive == 0"])"));
  EXPECT_FALSE(simulation.stopped());
  simulation.run_for(100);
  EXPECT_EQ(simulation.tick(), 52u) << "5.1 m, 0.1 m each tick from the second on";
  EXPECT_EQ(simulation.stopped(), "displacement >= 5.01");
  simulation.run_for(1);
  EXPECT_EQ(simulation.tick(), 52u) << "run_for() makes no further step";
  simulation.step();
  EXPECT_EQ(simulation.tick(), 53u) << "step() does not test the condition";
  simulation.reset();
  EXPECT_FALSE(simulation.stopped());
  simulation.run_for(100);
  EXPECT_EQ(simulation.tick(), 52u) << "and again after a reset";
}

TEST_F(StopWhen, WhatIsRememberedOfTheWayIsInTheCheckpoint) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  // Cells of 1 m, of which the robot has been on those from 0 to n: 21 x 2 of them are free.
  const fs::path file = world(R"("stop_when": ["coverage >= 0.2"])");
  Simulation straight(file);
  straight.run_for(100);
  const std::uint64_t end = straight.tick();
  EXPECT_THAT(end, ::testing::AnyOf(81u, 82u)) << "0.2 * 42 = 8.4: the ninth cell begins at x = 8";
  Simulation first(file);
  first.run_for(5);
  first.save(folder_ / "run.h5");
  Simulation resumed = Simulation::resume(folder_ / "run.h5");
  EXPECT_FALSE(resumed.stopped());
  resumed.run_for(100);
  EXPECT_EQ(resumed.tick(), end);
  EXPECT_EQ(resumed.stopped(), "coverage >= 0.2");
  resumed.save(folder_ / "end.h5");

  Simulation over = Simulation::resume(folder_ / "end.h5");
  EXPECT_EQ(over.stopped(), "coverage >= 0.2") << "what was over is over";
  over.run_for(1);
  EXPECT_EQ(over.tick(), end);
  ResumeOptions options;
  options.set = {{"/stop_when", R"(["displacement > 10"])"}};
  Simulation longer = Simulation::resume(folder_ / "end.h5", options);
  EXPECT_FALSE(longer.stopped());
  longer.run_for(100);
  EXPECT_EQ(longer.stopped(), "displacement > 10");
}

TEST_F(StopWhen, AChangedConditionKeepsWhatItsMeasureRemembers) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  const fs::path file = world(R"("stop_when": ["coverage >= 0.1"])");
  SimulationOptions farther;
  farther.set = {{"/stop_when", R"(["coverage >= 0.2"])"}};
  Simulation straight(file, farther);
  straight.run_for(100);
  Simulation first(file);
  first.run_for(100);
  EXPECT_EQ(first.stopped(), "coverage >= 0.1");
  first.save(folder_ / "run.h5");
  ResumeOptions options;
  options.set = farther.set;
  Simulation resumed = Simulation::resume(folder_ / "run.h5", options);
  EXPECT_THAT(resumed.warnings(), IsEmpty());
  EXPECT_FALSE(resumed.stopped());
  resumed.run_for(100);
  EXPECT_EQ(resumed.tick(), straight.tick());
  // A measure with other parameters begins again, and this is said.
  options.set = {{"/stop_when", R"([{"measure": {"kind": "coverage", "cell_m": 0.5}, "is": ">= 0.9"}])"}};
  const Simulation finer = Simulation::resume(folder_ / "run.h5", options);
  EXPECT_THAT(
      finer.warnings(),
      ElementsAre(HasSubstr(fmt::format(
          "run.h5: warning: the checkpoint has no data of earlier ticks for the measure \"coverage\" of "
          "stop_when, which is new, or whose parameters or bounds were changed: the measure begins at tick "
          "{}",
          first.tick()))));
}

TEST_F(StopWhen, WhatIsWrongIsToldWithItsPlace) {
  const auto error_of = [&](const std::string& keys) {
    try {
      Simulation simulation(world(keys));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_THAT(
      error_of(R"("stop_when": ["displacement:q > 3"])"),
      HasSubstr("w.json:4: error: /stop_when/0: unknown type or population of robots \"q\"; known: bot"));
  EXPECT_THAT(
      error_of(
          R"("at": [{"time_s": 5, "enable": {"type": "bot"}}, {"time_s": 3, "remove": {"population": "r"}}])"),
      HasSubstr("w.json:4: error: /at/1: unknown population \"r\""));
  EXPECT_THAT(error_of(R"("faults": [{"population": "r", "drop_out": {"rate_per_s": 1}}])"),
              HasSubstr("w.json:4: error: /faults/0: unknown population \"r\""));
}

TEST_F(StopWhen, ThereIsNothingToStopWhereNothingIsSaid) {
  Simulation simulation(world(R"("title": "plain")"));
  simulation.run_for(3);
  EXPECT_EQ(simulation.tick(), 30u);
  EXPECT_FALSE(simulation.stopped());
}

}  // namespace
}  // namespace troupe::experiment_test
