#include "engine/world/world.hpp"
#include "models/devices/flags.hpp"
#include "models/devices/power.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/troupe.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string>

namespace troupe::energy_test {
namespace {

namespace fs = std::filesystem;

const fs::path k_worlds = test::source_dir() / "worlds";

/// The state of the first device of a kind of a body, by its name.
const engine::BodyType::Device& device_of(const engine::World& world, BodyId body, std::string_view kind) {
  for (const engine::BodyType::Device& device : world.view().type(world.view().row(body)).devices)
    if (device.kind->name == kind) return device;
  throw std::out_of_range(std::string(kind));
}
const models::PowerPackState& pack_of(const Simulation& simulation, std::string_view name) {
  const engine::World& world = simulation.world();
  const BodyId body = world.state().names.find(name);
  return world.tables()[(device_of(world, body, "power_pack")).table].as<models::PowerPackState>(
      world.view().slot(world.view().row(body)));
}
std::uint64_t flags_received(const Simulation& simulation, std::string_view name) {
  const engine::World& world = simulation.world();
  const BodyId body = world.state().names.find(name);
  return world.tables()[(device_of(world, body, "flags")).table].cell<std::uint64_t>(
      world.view().slot(world.view().row(body)), models::k_flag_received)[0];
}

TEST(EnergyScene, TheShuttleChargesAndTheWalkerStandsWhereItsPackRanOut) {
  Simulation simulation(k_worlds / "energy.json", {.threads = 1});
  simulation.run_for(60);
  // docs/energy.md: 1 W at rest, 5 W while it drove for 5 s, 1.5 W from the dock since tick 52.
  EXPECT_NEAR(pack_of(simulation, "shuttle").stored, 47.35, 1e-9);
  EXPECT_NEAR(simulation.find("shuttle").pose().x, -3 + 2.5, 1e-9);
  EXPECT_EQ(pack_of(simulation, "walker").stored, 0);
  EXPECT_NEAR(simulation.find("walker").pose().x, -3 + 20 * 0.05, 1e-9);
}

TEST(EnergyScene, NothingIsLostBetweenGiversAndTakers) {
  Simulation simulation(k_worlds / "energy.json", {.threads = 2});
  simulation.run_for(test::k_slow_build ? 5 : 60);
  double given = 0;
  double received = 0;
  const engine::World& world = simulation.world();
  for (std::size_t r = 0; r < world.view().rows(); ++r) {
    const Row row(r);
    const std::string name = world.spec().name(world.view().body(row));
    const models::PowerPackState& pack = pack_of(simulation, name);
    given += pack.given;
    received += pack.received;
    EXPECT_GE(pack.stored, 0) << name;
    EXPECT_LE(pack.stored, pack.capacity) << name;
  }
  EXPECT_NEAR(given, received, 1e-9);
  EXPECT_GT(given, 0);
}

TEST(EnergyScene, ModelsTellOfTheirPacksAndTheSimulationOfAll) {
  Simulation simulation(k_worlds / "energy.json", {.threads = 1});
  simulation.run_for(test::k_slow_build ? 6 : 60);
  const std::optional<Model::Energy> shuttle = simulation.find("shuttle").energy();
  ASSERT_TRUE(shuttle);
  const models::PowerPackState& pack = pack_of(simulation, "shuttle");
  EXPECT_EQ(shuttle->stored_j, pack.stored);
  EXPECT_EQ(shuttle->capacity_j, 100);
  EXPECT_EQ(shuttle->dissipated_j, pack.dissipated);
  EXPECT_EQ(shuttle->received_j, pack.received);
  EXPECT_GT(shuttle->received_j, 0);
  EXPECT_EQ(shuttle->given_j, 0);
  EXPECT_FALSE(shuttle->infinite);
  EXPECT_TRUE(shuttle->charging);
  EXPECT_FALSE(simulation.find("walker").energy()->charging);

  const engine::World& world = simulation.world();
  double stored = 0;
  for (std::size_t b = 0; b < world.spec().bodies.size(); ++b) {
    const auto energy = simulation.find(world.spec().name(BodyId(b))).energy();
    stored += energy ? energy->stored_j : 0;
  }
  const Model::Energy sum = simulation.energy();
  EXPECT_EQ(sum.stored_j, stored);
  EXPECT_NEAR(sum.given_j, sum.received_j, 1e-9);
  EXPECT_GT(sum.dissipated_j, shuttle->dissipated_j);
  EXPECT_TRUE(sum.infinite);
  EXPECT_TRUE(sum.charging);
}

class EnergyOfModels : public test::ScratchTest {};

TEST_F(EnergyOfModels, PartsRunOnThePackBelowThemAndFlagsAreTheirOwn) {
  Simulation simulation(
      write("w.world",
            "model( name \"base\" joules 10 alwayson 1 watts 1 model( name \"top\" )\n"
            "  model( name \"box\" kjoules 2 model( name \"lid\" ) ) )\n"
            "model( name \"mains\" pose [2 0 0 0] joules -1 )\n"
            "model( name \"stone\" pose [4 0 0 0] )\n"
            "model( name \"source\" pose [6 0 0 0] ctrl \"source 3\" model( name \"sign\" ) )\n"),
      {.threads = 1});
  EXPECT_EQ(simulation.find("source").flag_count(), 0u);
  simulation.run_for(2);
  EXPECT_NEAR(simulation.find("base").energy()->stored_j, 8, 1e-12);
  EXPECT_NEAR(simulation.find("base.top").energy()->stored_j, 8, 1e-12);
  EXPECT_EQ(simulation.find("base.box").energy()->stored_j, 2000);
  EXPECT_EQ(simulation.find("base.box.lid").energy()->capacity_j, 2000);
  EXPECT_TRUE(simulation.find("mains").energy()->infinite);
  EXPECT_FALSE(simulation.find("stone").energy());
  EXPECT_FALSE(simulation.find("source").energy());
  EXPECT_EQ(simulation.find("source").flag_count(), 3u);
  EXPECT_EQ(simulation.find("source.sign").flag_count(), 0u);
  EXPECT_EQ(simulation.find("stone").flag_count(), 0u);
}

TEST(EnergyScene, DependsOnNeitherThreadsNorTiles) {
  for (const scenes::Run& run : scenes::runs_of("energy")) {
    if (test::k_slow_build && run.world == "foraging.json") continue;  // its ways take long to find
    std::string first;
    for (const auto& [threads, tile_m] : {std::pair(1u, 0.0), std::pair(8u, 0.7), std::pair(2u, 20.0)}) {
      Simulation simulation(run.file(), {.threads = threads, .tile_size_m = tile_m});
      simulation.run_for(test::k_slow_build ? 2 : 20);
      if (first.empty()) first = simulation.hash_log_line();
      EXPECT_EQ(simulation.hash_log_line(), first) << run << ", " << threads << " threads";
    }
  }
}

TEST(ForagingScene, FlagsArriveAtTheSink) {
  if (test::k_slow_build) GTEST_SKIP() << "it takes minutes";
  Simulation simulation(k_worlds / "foraging.json", {.threads = 1});
  simulation.run_for(300);
  EXPECT_GE(flags_received(simulation, "sink"), 12);  // more than one each
  double received = 0;
  for (const std::string& name : simulation.robot_names()) received += pack_of(simulation, name).received;
  EXPECT_GT(received, 1000);
}

}  // namespace
}  // namespace troupe::energy_test
