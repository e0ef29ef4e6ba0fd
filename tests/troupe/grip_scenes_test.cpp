// The scenes of grippers and actuators, with results that were computed by hand: docs/gripping.md.

#include "engine/observing/events.hpp"
#include "engine/world/world.hpp"
#include "models/devices/actuator.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/slow_build.hpp"
#include "tests/troupe/golden_hashes.hpp"
#include "troupe/troupe.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace troupe::grip_scenes_test {
namespace {

namespace fs = std::filesystem;

const fs::path k_worlds = test::source_dir() / "worlds";

void run_to(Simulation& simulation, std::uint64_t tick) {
  while (simulation.tick() < tick) simulation.step();
}

// Fetcher k stands 1 m from the middle, at 60 k degrees, and looks outwards. It goes 0.6 m, to a puck 0.3 m
// ahead at 1.9 m, and with it 0.8 m back: the puck lies at 1.9 - 2 * 0.3 - 0.8 = 0.5 m. Then 0.4 m out
// backwards, 1.2 m further to 2.4 m, a puck 0.3 m ahead at 2.7 m, and 1.44 m in: that one lies at 0.66 m.
TEST(GripperScene, EveryPuckLiesInTheDropZone) {
  Simulation simulation(k_worlds / "gripper.json", {.threads = 1});
  engine::World& world = simulation.world();
  engine::EventWatch watch(world);
  std::map<std::string, int> grips;
  std::map<std::string, int> releases;
  std::size_t stalls = 0;
  while (simulation.time_s() < 40) {
    simulation.step();
    stalls += world.view().counts().stalled;
    for (const engine::Event& event : watch.see(world)) {
      if (event.type == engine::EventType::grip) ++grips[world.spec().name(event.other)];
      if (event.type == engine::EventType::release) ++releases[world.spec().name(event.other)];
    }
    if (simulation.tick() == 45) {
      for (int n = 1; n <= 6; ++n) EXPECT_EQ(grips[std::string("puck").append(std::to_string(n))], 1) << n;
    }
  }
  EXPECT_EQ(stalls, 0u);
  for (int n = 1; n <= 12; ++n) {
    const std::string name = std::string("puck").append(std::to_string(n));
    EXPECT_EQ(grips[name], 1) << name;
    EXPECT_EQ(releases[name], 1) << name;
    const double away = n <= 6 ? 0.5 : 0.66;
    const double bearing = radians(60.0 * ((n - 1) % 6));
    const Pose pose = simulation.find(name).pose();
    EXPECT_NEAR(pose.x, away * std::cos(bearing), 1e-5) << name;
    EXPECT_NEAR(pose.y, away * std::sin(bearing), 1e-5) << name;
    EXPECT_NEAR(pose.z, 0, 1e-12) << name;
  }
  const Pose twelve = simulation.find("puck12").pose();
  EXPECT_NEAR(twelve.x, 0.33, 0.02);
  EXPECT_NEAR(twelve.y, -0.572, 0.02);
}

const models::ActuatorState& actuator(const Simulation& simulation, std::string_view body) {
  const engine::World& world = simulation.world();
  const Row row = world.view().row(world.state().names.find(body));
  for (const engine::BodyType::Device& device : world.view().type(row).devices)
    if (device.kind->name == "actuator")
      return world.tables()[device.table].as<models::ActuatorState>(world.view().slot(row));
  throw std::out_of_range(std::string(body));
}

// Robots of 0.4 m, 0.28 m high, come at 0.05 m a tick to a panel whose face is at -0.05 m: the last place
// before it is -0.27 m. The panel rises by 0.03 m a tick from tick 51 on, comes down from tick 91 on.
TEST(GateScene, OpensForTheFirstWaitsForTheSecondAndShutsOutTheThird) {
  Simulation simulation(k_worlds / "gate.json", {.threads = 1});
  const auto x_of = [&](const char* name) { return simulation.find(name).pose().x; };
  run_to(simulation, 50);
  EXPECT_NEAR(x_of("early"), -0.27, 1e-9);
  EXPECT_TRUE(simulation.find("early").stalled());
  EXPECT_EQ(actuator(simulation, "gate").position, 0);
  run_to(simulation, 60);
  EXPECT_NEAR(actuator(simulation, "gate").position, 0.3, 1e-9) << "the first gap of more than 0.28 m";
  EXPECT_NEAR(x_of("early"), -0.27, 1e-9);
  run_to(simulation, 61);
  EXPECT_NEAR(x_of("early"), -0.22, 1e-9);
  run_to(simulation, 120);
  EXPECT_NEAR(x_of("early"), 2.73, 1e-9);
  EXPECT_NEAR(x_of("slow"), 0.03, 1e-9) << "it stands under the gate";
  EXPECT_NEAR(actuator(simulation, "gate").position, 0.3, 1e-9) << "which does not come down on it";
  EXPECT_EQ(actuator(simulation, "gate").stalled, 1);
  run_to(simulation, 154);
  EXPECT_NEAR(actuator(simulation, "gate").position, 0.3, 1e-9);
  run_to(simulation, 165);
  EXPECT_EQ(actuator(simulation, "gate").position, 0);
  run_to(simulation, 200);
  EXPECT_NEAR(x_of("slow"), 1.03, 1e-9);
  EXPECT_NEAR(x_of("late"), -0.27, 1e-9);
  EXPECT_TRUE(simulation.find("late").stalled());
}

// The laser's beams leave above the mast, which ends at 0.5 m; the wall is 0.7 m high.
TEST(LiftScene, TheLaserSeesOverTheWallOnceTheMastIsUp) {
  Simulation simulation(k_worlds / "lift.world", {.threads = 1});
  const auto ahead = [&] { return simulation.find("r0").ranges()[15]; };
  run_to(simulation, 20);
  EXPECT_NEAR(ahead(), 1.5, 1e-5);
  EXPECT_EQ(actuator(simulation, "r0").position, 0);
  run_to(simulation, 55);
  EXPECT_NEAR(actuator(simulation, "r0").position, 0.6, 1e-9);
  EXPECT_NEAR(simulation.find("r0.mast.laser").pose().z, 0.5 + 0.6, 1e-9);
  EXPECT_NEAR(ahead(), 4, 1e-5);
  run_to(simulation, 120);
  EXPECT_EQ(actuator(simulation, "r0").position, 0);
  EXPECT_NEAR(ahead(), 1.5, 1e-5);
}

TEST(MagpieScene, RobotsSnatchPucksAndOneAnother) {
  Simulation simulation(k_worlds / "magpies.json", {.threads = 2});
  const engine::World& world = simulation.world();
  std::size_t most_carried = 0;
  std::size_t most_in_chains = 0;  // carried by what is carried itself
  const std::uint64_t ticks = test::k_slow_build ? 15 : 600;
  while (simulation.tick() < ticks) {
    simulation.step();
    most_carried = std::max(most_carried, world.view().counts().carried);
    std::size_t in_chains = 0;
    for (std::size_t r = 0; r < world.view().rows(); ++r)
      if (const auto carrier = world.view().carrier(Row(r)))
        in_chains += world.view().carrier(world.view().row(*carrier)).has_value();
    most_in_chains = std::max(most_in_chains, in_chains);
  }
  if (test::k_slow_build) return;
  EXPECT_GT(most_carried, 10u);
  EXPECT_GE(most_in_chains, 3u);
}

TEST(GripScenes, DependOnNeitherThreadsNorTiles) {
  const auto golden = test::golden_hashes();
  for (scenes::Run run : scenes::runs_of("grips")) {
    run.ticks = test::k_slow_build ? 10 : 50;
    std::vector<std::string> expected;
    for (const auto& [threads, tile_m] : {std::pair(1u, 0.0), std::pair(8u, 0.7), std::pair(2u, 5.3)}) {
      Simulation simulation(run.file(), {.threads = threads, .tile_size_m = tile_m});
      std::vector<std::string> lines;
      while (simulation.tick() < run.ticks) {
        simulation.step();
        lines.push_back(simulation.hash_log_line());
      }
      if (expected.empty()) expected = lines;
      EXPECT_EQ(lines, expected) << run << ", " << threads << " threads, tiles of " << tile_m << " m";
    }
    if (test::k_slow_build) continue;
    const test::GoldenRun line = test::golden_run(run);
    ASSERT_TRUE(golden.contains(line)) << run;
    EXPECT_EQ(expected.back().substr(expected.back().find(' ') + 1, 16), golden.at(line)) << run;
  }
}

}  // namespace
}  // namespace troupe::grip_scenes_test
