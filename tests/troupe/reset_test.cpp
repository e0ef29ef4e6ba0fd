// Simulation::reset() gives the state after loading, bit for bit, and then the same run.

#include "base/fp_environment.hpp"
#include "engine/world.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/registry.hpp"
#include "troupe/troupe.hpp"
#include "worldio/load.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

namespace troupe {
namespace {

namespace fs = std::filesystem;

const fs::path k_worlds = fs::path(TROUPE_SOURCE_DIR) / "worlds";
constexpr int k_ticks = test::k_slow_build ? 4 : 25;

struct Scene {
  std::string name;
  std::string world;
  RangingEngine ranging = RangingEngine::exact;
  unsigned threads = 1;
};

class ResetScene : public ::testing::TestWithParam<Scene> {};
INSTANTIATE_TEST_SUITE_P(
    World, ResetScene,
    ::testing::Values(Scene{"crowd", "crowd.json"},
                      Scene{"crowdOnThreeThreads", "crowd.json", RangingEngine::exact, 3},
                      Scene{"crowdOnTheGrid", "crowd.json", RangingEngine::grid, 2},
                      Scene{"caveWithLasers", "cave-complex-laser.json"}, Scene{"magpies", "magpies.json"},
                      Scene{"clustering", "clustering.json"},
                      Scene{"magpiesOnTheGrid", "magpies.json", RangingEngine::grid, 2}),
    [](const auto& scene) { return scene.param.name; });

/// Every byte of every table, and what is derived from them.
std::string bytes_of(const engine::World& world) {
  std::string all;
  const auto add = [&all](const auto& values) {
    all.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
  };
  for (const engine::StateTable& table : world.tables())
    for (std::size_t field = 0; field < table.fields().size(); ++field)
      for (std::size_t row = 0; row < table.rows(); ++row) {
        const std::size_t bytes =
            engine::element_size(table.fields()[field].element) * table.fields()[field].columns;
        all.append(reinterpret_cast<const char*>(table.cell<std::uint8_t>(row, field).data()), bytes);
      }
  for (std::size_t row = 0; row < world.rows(); ++row) {
    const Transform& transform = world.transform(Row(row));
    add(std::array{transform.position.x(), transform.position.y(), transform.rotation.cos,
                   transform.rotation.sin});
    for (const Vec2& vertex : world.outline(Row(row))) add(std::array{vertex.x(), vertex.y()});
  }
  return all;
}

TEST_P(ResetScene, IsTheStateAfterLoadingByteForByte) {
  const engine::Registry registry = make_registry();
  Diagnostics diagnostics;
  engine::WorldSpec spec = worldio::load_world(k_worlds / GetParam().world, registry, {}, diagnostics);
  spec.ranging = GetParam().ranging;
  engine::World world(std::move(spec), registry, {.threads = GetParam().threads, .tile_size_m = 0},
                      diagnostics);
  const std::string loaded = bytes_of(world);
  for (int tick = 0; tick < k_ticks; ++tick) world.step();
  const std::string later = bytes_of(world);
  ASSERT_NE(later, loaded);

  world.reset();
  EXPECT_EQ(world.tick(), 0u);
  EXPECT_TRUE(bytes_of(world) == loaded);
  EXPECT_EQ(world.index().order().size(), world.rows());
  for (int tick = 0; tick < k_ticks; ++tick) world.step();
  EXPECT_TRUE(bytes_of(world) == later);
}

TEST_P(ResetScene, IsFollowedByTheSameRun) {
  SimulationOptions options;
  options.ranging = GetParam().ranging;
  options.threads = GetParam().threads;
  Simulation simulation(k_worlds / GetParam().world, options);
  const auto run = [&](int ticks) {
    std::string log = simulation.hash_log_line() + "\n";
    for (int tick = 0; tick < ticks; ++tick) {
      simulation.step();
      log += simulation.hash_log_line() + "\n";
    }
    return log;
  };
  const std::string first = run(k_ticks);
  const Statistics after = simulation.statistics();
  simulation.reset();
  run(3);  // a reset need not come at the end of a whole run
  simulation.reset();
  EXPECT_EQ(run(k_ticks), first);
  const Statistics again = simulation.statistics();
  EXPECT_EQ(again.ticks, after.ticks);
  EXPECT_EQ(again.time_s, after.time_s);
  EXPECT_EQ(again.beams, after.beams);
  EXPECT_EQ(again.stalled, after.stalled);
  EXPECT_EQ(again.held_at_bounds, after.held_at_bounds);
  EXPECT_EQ(again.mean_displacement_m, after.mean_displacement_m);
}

constexpr std::string_view k_room = R"({
  "troupe": 1,
  "types": {
    "wall": {"size_m": [0.2, 4, 1]},
    "bot": {"size_m": [0.4, 0.3, 0.25], "drive": {"kind": "diff"}, "sensors": [
      {"name": "eye", "kind": "ranger", "active": false, "pose": {"z_m": 0.1},
       "transducers": [{"range_max_m": 5}]}]}
  },
  "models": [
    {"name": "wall", "type": "wall", "pose": {"x_m": 2}},
    {"name": "r0", "type": "bot", "pose": {"heading_deg": 0}}
  ]
})";

class Reset : public test::ScratchTest {};

TEST_F(Reset, ForgetsCountersSpeedsAndReadings) {
  Simulation simulation(write("room.json", k_room));
  simulation.subscribe("r0");
  Model robot = simulation.find("r0");
  robot.set_speed(5, 0);
  simulation.run_for(3);
  ASSERT_TRUE(robot.stalled());
  ASSERT_GT(simulation.statistics().beams, 0u);

  simulation.reset();
  const Statistics statistics = simulation.statistics();
  EXPECT_EQ(simulation.time_s(), 0);
  EXPECT_EQ(statistics.ticks, 0u);
  EXPECT_EQ(statistics.beams, 0u);
  EXPECT_EQ(statistics.stalled, 0u);
  EXPECT_EQ(statistics.conflict_rounds, 0u);
  EXPECT_EQ(statistics.mean_displacement_m, 0);
  EXPECT_FALSE(robot.stalled());
  EXPECT_EQ(robot.pose().x, 0);
  EXPECT_EQ(robot.speed().forward, 0);
  EXPECT_EQ(robot.ranges()[0], 0);
  simulation.run_for(1);
  EXPECT_EQ(robot.pose().x, 0) << "the speed that was set before the reset still acts";
}

TEST_F(Reset, KeepsWhatTheProgramSet) {
  Simulation simulation(write("room.json", k_room));
  simulation.subscribe("r0");
  int phases = 0;
  simulation.on_phase([&phases](std::optional<Phase>) { ++phases; });
  simulation.step();
  simulation.reset();
  EXPECT_EQ(phases, 5) << "a reset is no phase";
  simulation.step();
  EXPECT_EQ(phases, 10);
  EXPECT_FLOAT_EQ(simulation.find("r0").ranges()[0], 1.9f);
}

TEST_F(Reset, TakesSubscriptionsAgain) {
  Simulation simulation(write("room.json", k_room));
  simulation.step();
  EXPECT_THROW(simulation.subscribe("r0"), std::logic_error);
  simulation.reset();
  simulation.subscribe("r0");
  simulation.step();
  EXPECT_FLOAT_EQ(simulation.find("r0").ranges()[0], 1.9f);
}

TEST_F(Reset, MakesAWorldOfUseAgainWhoseStepThrew) {
  Simulation simulation(write("room.json", k_room));
  const std::uint64_t loaded = simulation.state_hash();
  simulation.find("r0").set_speed(std::numeric_limits<double>::quiet_NaN(), 0);
  EXPECT_THROW(simulation.step(), std::runtime_error);
  simulation.reset();
  EXPECT_EQ(simulation.state_hash(), loaded);
  EXPECT_NO_THROW(simulation.step());
}

}  // namespace
}  // namespace troupe
