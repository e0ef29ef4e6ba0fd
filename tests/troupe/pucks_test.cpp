// worlds/pucks.json: finders, grippers, power packs, wells and a mill together.

#include "engine/world/world.hpp"
#include "models/devices/gripper.hpp"
#include "models/devices/power.hpp"
#include "models/devices/remover.hpp"
#include "models/devices/spawner.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/troupe.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace troupe::pucks_test {
namespace {

const std::filesystem::path k_pucks = test::source_dir() / "worlds" / "pucks.json";

template <class State>
const State& state_of(const Simulation& simulation, std::string_view name, std::string_view kind) {
  const engine::World& world = simulation.world();
  const Row row = world.view().row(world.state().names.find(name));
  for (const engine::BodyType::Device& device : world.view().type(row).devices)
    if (device.kind->name == kind) return world.tables()[device.table].as<State>(world.view().slot(row));
  throw std::out_of_range(std::string(kind));
}

std::size_t pucks_there(const engine::World& world) {
  std::size_t count = 0;
  for (std::size_t r = 0; r < world.view().rows(); ++r)
    count +=
        world.view().is_there(Row(r)) && world.spec().name(world.view().body(Row(r))).starts_with("puck");
  return count;
}

TEST(PucksScene, PucksAreGrippedAndGroundAndComeAgain) {
  Simulation simulation(k_pucks, {.threads = 1});
  const engine::World& world = simulation.world();
  std::size_t most_carried = 0;
  const int ticks = test::k_slow_build ? 100 : 3000;
  for (int tick = 0; tick < ticks; ++tick) {
    simulation.step();
    most_carried = std::max(most_carried, world.view().counts().carried);
  }
  const auto born0 = state_of<models::SpawnerState>(simulation, "well0", "spawner").born;
  const auto born1 = state_of<models::SpawnerState>(simulation, "well1", "spawner").born;
  const auto ground = state_of<models::RemoverState>(simulation, "mill", "remover").removed;
  EXPECT_EQ(pucks_there(world), 30 + born0 + born1 - ground) << "nothing is lost, nothing comes from nowhere";
  EXPECT_EQ(simulation.unborn("puck"), 200 - born0 - born1);
  if (test::k_slow_build) return;
  EXPECT_EQ(born0 + state_of<models::SpawnerState>(simulation, "well0", "spawner").owed, 50u) << "in 300 s";
  EXPECT_GT(ground, 15u);
  EXPECT_GT(most_carried, 2u);
  double received = 0;
  for (const std::string& name : simulation.robot_names())
    received += state_of<models::PowerPackState>(simulation, name, "power_pack").received;
  EXPECT_GT(received, 1000);
}

TEST(PucksScene, DependsOnNeitherThreadsNorTiles) {
  std::string first;
  for (const auto& [threads, tile_m] : {std::pair(1u, 0.0), std::pair(8u, 0.7), std::pair(2u, 20.0)}) {
    Simulation simulation(k_pucks, {.threads = threads, .tile_size_m = tile_m});
    simulation.run_for(test::k_slow_build ? 5 : 60);
    if (first.empty()) first = simulation.hash_log_line();
    EXPECT_EQ(simulation.hash_log_line(), first) << threads << " threads";
  }
}

}  // namespace
}  // namespace troupe::pucks_test
