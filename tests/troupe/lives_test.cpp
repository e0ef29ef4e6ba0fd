// Births and deaths in programs and files: worlds/colony.json and the C++ interface.

#include "engine/world/world.hpp"
#include "models/devices/led.hpp"
#include "models/devices/power.hpp"
#include "models/devices/spawner.hpp"
#include "tests/support/hash_log.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/recording.hpp"
#include "troupe/troupe.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace troupe::lives_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const fs::path k_colony = test::source_dir() / "worlds" / "colony.json";

// Of walkers, docs/lives.md: one is born every 20 ticks from tick 20 on, and dies 102 ticks later.
constexpr std::uint64_t k_every = 20;
constexpr std::uint64_t k_life = 102;
constexpr int k_ticks = test::k_slow_build ? 130 : 300;

std::size_t alive(const Simulation& simulation, std::string_view prefix) {
  std::size_t count = 0;
  for (const std::string& name : simulation.robot_names()) count += name.starts_with(prefix);
  return count;
}

template <class State>
const State& state_of(const Simulation& simulation, std::string_view name, std::string_view kind) {
  const engine::World& world = simulation.world();
  const Row row = world.view().row(world.state().names.find(name));
  for (const engine::BodyType::Device& device : world.view().type(row).devices)
    if (device.kind->name == kind) return world.tables()[device.table].as<State>(world.view().slot(row));
  throw std::out_of_range(std::string(kind));
}

void step(Simulation& simulation, int ticks) {
  for (int tick = 0; tick < ticks; ++tick) simulation.step();
}

TEST(ColonyScene, WalkersLiveAsLongAsTheirPacksLast) {
  Simulation simulation(k_colony, {.threads = 2});
  for (std::uint64_t tick = 1; tick <= k_ticks; ++tick) {
    simulation.step();
    const std::uint64_t born = tick / k_every;
    const std::uint64_t dead = tick < k_life ? 0 : (tick - k_life) / k_every;
    ASSERT_EQ(alive(simulation, "walker"), born - dead) << "tick " << tick;
  }
  if (test::k_slow_build) return;
  EXPECT_EQ(alive(simulation, "walker"), 6u) << "of 15 that were born";
  // 59.9 J after a tick at rest are 100 motions of 0.05 m at 0.6 J, the last of them at less.
  EXPECT_NEAR(simulation.find("walker0").pose().x, -6 + 5, 1e-9);
  EXPECT_NEAR(simulation.find("walker0").pose().y, -7.5, 1e-9);
  EXPECT_FALSE(simulation.find("walker0").is_alive());
  EXPECT_TRUE(simulation.find("walker14").is_alive());
  EXPECT_FALSE(simulation.find("walker15").is_alive());
  EXPECT_TRUE(std::isnan(simulation.find("walker15").pose().x));
}

TEST(ColonyScene, AntsAreBornForEveryTwoFlagsAndDieWithEmptyPacks) {
  if (test::k_slow_build) GTEST_SKIP() << "it takes minutes";
  Simulation simulation(k_colony, {.threads = 1});
  std::map<std::string, double> last;  // J, of each ant that is alive
  std::size_t deaths = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    simulation.step();
    std::map<std::string, double> now;
    for (const std::string& name : simulation.robot_names())
      if (name.starts_with("ant"))
        now[name] = state_of<models::PowerPackState>(simulation, name, "power_pack").stored;
    for (const auto& [name, joules] : last)
      if (!now.contains(name)) {
        EXPECT_EQ(joules, 0) << name << " died in tick " << tick;
        ++deaths;
      }
    last = std::move(now);
  }
  const auto& brood = state_of<models::SpawnerState>(simulation, "nest", "spawner");
  EXPECT_GE(brood.born, 5u);
  EXPECT_GE(deaths, 8u) << "those of the start at least";
  EXPECT_EQ(brood.born + brood.owed, brood.flags / 2);
  EXPECT_EQ(last.size() + deaths, 8 + brood.born);
  EXPECT_EQ(simulation.unborn("ant"), 60 - brood.born);
}

TEST(ColonyScene, DependsOnNeitherThreadsNorTilesAndComesAgain) {
  Simulation first(k_colony, {.threads = 1});
  const std::vector<std::string> expected = test::hash_log(first, k_ticks);
  for (const auto& [threads, tile_m] : {std::pair(2u, 0.7), std::pair(8u, 20.0)}) {
    Simulation simulation(k_colony, {.threads = threads, .tile_size_m = tile_m});
    EXPECT_EQ(test::hash_log(simulation, k_ticks), expected) << threads << " threads";
  }
  first.reset();
  EXPECT_EQ(test::hash_log(first, k_ticks), expected) << "after a reset";
}

class Lives : public test::ScratchTest {
 protected:
  static constexpr const char* k_world = R"({
    "troupe": 1,
    "types": {
      "wall": {"size_m": [0.2, 4, 1]},
      "bot": {"size_m": [0.4, 0.4, 0.4], "drive": {"kind": "diff"}}
    },
    "models": [{"name": "wall", "type": "wall", "pose": {"x_m": 3}}, {"name": "r", "type": "bot"}],
    "populations": [{"name": "more", "type": "bot", "count": 1, "reserve": 2,
                     "place": {"rule": "grid", "region_m": [[0, 2], [1, 3]], "pitch_m": 1}}]
  })";
};

TEST_F(Lives, ARunGoesOnFromTheMiddleOfThem) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  const int before = test::k_slow_build ? 110 : 205;
  Simulation straight(k_colony, {.threads = 1});
  step(straight, before);
  straight.save(folder_ / "run.h5");
  const std::vector<std::string> expected = test::hash_log(straight, k_ticks - before);
  for (const auto& [threads, tile_m] : {std::pair(1u, 0.0), std::pair(3u, 1.7)}) {
    Simulation resumed = Simulation::resume(folder_ / "run.h5", {.threads = threads, .tile_size_m = tile_m});
    EXPECT_EQ(test::hash_log(resumed, k_ticks - before), expected) << threads << " threads";
    EXPECT_EQ(resumed.robot_names(), straight.robot_names());
    EXPECT_EQ(resumed.statistics().mean_displacement_m, straight.statistics().mean_displacement_m);
  }
}

TEST_F(Lives, ARecordingTellsWhoIsThere) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  Simulation simulation(write("w.json", k_world));
  {
    Recording recording(folder_ / "r.h5", simulation, {.fields = {"pose", "stall", "life"}, .every_s = 0.1});
    const auto next = [&] {
      simulation.step();
      recording.observe(simulation);
    };
    next();
    ASSERT_TRUE(simulation.spawn("more", {-1, 0, 0, 0}));
    next();
    simulation.remove(simulation.find("r"));
    next();
    recording.close();
  }
  const worldio::Hdf5File file = worldio::Hdf5File::open(folder_ / "r.h5");
  const auto state = file.group("state");
  // Frames of four rows: r, more0, more1, more2.
  EXPECT_EQ(state.dataset("alive").read<std::uint8_t>(),
            (std::vector<std::uint8_t>{1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 1, 0, 0, 1, 1, 0}));
  const auto x = state.group("pose").dataset("x").read<double>();
  ASSERT_EQ(x.size(), 16u);
  for (const std::size_t absent : {2u, 3u, 6u, 7u, 11u, 12u, 15u})
    EXPECT_TRUE(std::isnan(x[absent])) << absent;
  EXPECT_EQ(x[10], -1);
  EXPECT_EQ(x[8], 0);
  const auto presence = state.group("life").dataset("presence").read<std::uint8_t>();
  EXPECT_EQ(std::vector(presence.end() - 4, presence.end()), (std::vector<std::uint8_t>{2, 0, 0, 1}));
}

TEST_F(Lives, ProgramsBearAndRemove) {
  Simulation simulation(write("w.json", k_world));
  EXPECT_EQ(simulation.robots(), 2u);
  EXPECT_EQ(simulation.unborn("more"), 2u);
  const std::uint64_t hash = simulation.state_hash();
  simulation.step();
  std::optional<Model> born = simulation.spawn("more", {1, 0, 0, 0});
  ASSERT_TRUE(born);
  EXPECT_EQ(born->name(), "more1");
  EXPECT_TRUE(born->is_alive());
  EXPECT_FALSE(simulation.spawn("more", {1.2, 0, 0, 0})) << "that place is taken";
  EXPECT_FALSE(simulation.spawn("more", {2.9, 0, 0, 0})) << "by the wall";
  born->set_speed(1, 0);
  step(simulation, 5);
  EXPECT_NEAR(born->pose().x, 1.5, 1e-12);
  EXPECT_EQ(simulation.statistics().robots, 3u);
  EXPECT_NEAR(simulation.statistics().mean_displacement_m, 0.5 / 3, 1e-12);
  simulation.remove(*born);
  EXPECT_FALSE(born->is_alive());
  EXPECT_NEAR(born->pose().x, 1.5, 1e-12) << "where it died";
  EXPECT_EQ(simulation.robots(), 2u);
  EXPECT_THROW(born->set_speed(1, 0), std::logic_error);
  EXPECT_THROW(born->set_pose({0, 5, 0, 0}), std::invalid_argument);
  EXPECT_TRUE(simulation.spawn("more", {1.5, 0, 0, 0}));
  EXPECT_FALSE(simulation.spawn("more", {-2, 0, 0, 0})) << "none is left";
  EXPECT_EQ(simulation.unborn("more"), 0u);
  simulation.reset();
  EXPECT_EQ(simulation.state_hash(), hash);
  EXPECT_EQ(simulation.unborn("more"), 2u);
}

TEST_F(Lives, WheelsThatDoNotRunHaveNoSpeed) {
  Simulation simulation(write("w.json", R"({
    "troupe": 1, "tick_s": 0.1,
    "types": {
      "bot": {"size_m": [0.4, 0.4, 0.4], "drive": {"kind": "diff"},
              "devices": [{"name": "feet", "kind": "wheels", "pose": {"z_m": 0.4}, "size_m": [0.1, 0.1, 0.1]}]}
    },
    "models": [{"name": "r", "type": "bot"}],
    "at": [{"time_s": 0.3, "disable": {"model": "r"}}, {"time_s": 0.6, "enable": {"model": "r"}}]
  })"));
  Model feet = simulation.find("r.feet");
  feet.set_speed(0.5, 0);
  simulation.run_for(0.3);
  EXPECT_EQ(feet.speed().forward, 0.5);
  const double x = feet.pose().x;
  simulation.run_for(0.2);
  EXPECT_EQ(feet.speed().forward, 0) << "the body is disabled";
  EXPECT_FALSE(feet.stalled());
  EXPECT_EQ(feet.pose().x, x);
  simulation.run_for(0.2);
  EXPECT_EQ(feet.speed().forward, 0.5);
}

TEST_F(Lives, DevicesTakeNoCommandsBeforeTheBirthOrAfterTheDeath) {
  Simulation simulation(write("w.json", R"({
    "troupe": 1,
    "types": {
      "bot": {"size_m": [0.4, 0.4, 0.4], "drive": {"kind": "diff"},
              "devices": [{"name": "lamp", "kind": "led"},
                          {"name": "feet", "kind": "wheels", "pose": {"z_m": 0.4}, "size_m": [0.1, 0.1, 0.1]}]}
    },
    "populations": [{"name": "more", "type": "bot", "count": 0, "reserve": 2,
                     "place": {"rule": "grid", "region_m": [[0, 2], [1, 3]], "pitch_m": 1}}]
  })"));
  const std::uint64_t hash = simulation.state_hash();
  Model first = simulation.find("more0");
  const auto expect_refused = [&] {
    EXPECT_EQ(test::message_of<std::logic_error>([&] { first.command<models::LedCommand>("lamp"); }),
              "\"more0\" is not in the world: it is not yet born, or dead");
    EXPECT_THROW(first.asked("lamp"), std::logic_error);
    EXPECT_THROW(simulation.find("more0.feet").set_speed(1, 0), std::logic_error);
    EXPECT_EQ(first.command_fields("lamp").front().name, "shows");
    EXPECT_THROW(first.command_fields("eye"), std::out_of_range);
  };
  expect_refused();
  ASSERT_TRUE(simulation.spawn("more", {}));
  models::LedCommand& lamp = first.command<models::LedCommand>("lamp");
  simulation.find("more0.feet").set_speed(1, 0);
  simulation.reset();
  EXPECT_EQ(simulation.state_hash(), hash);
  lamp.show(1, 0, 0);
  ASSERT_TRUE(simulation.spawn("more", {}));
  EXPECT_EQ(lamp.shows, 0) << "a body is born without commands";
  simulation.remove(first);
  expect_refused();
}

TEST_F(Lives, WhatIsWrongIsTold) {
  Simulation simulation(write("w.json", k_world));
  const std::string error = test::message_of<std::out_of_range>([&] { simulation.spawn("mroe", {}); });
  EXPECT_THAT(error, HasSubstr("no population \"mroe\" with a reserve in"));
  EXPECT_THAT(error, HasSubstr("known: more"));
  EXPECT_THROW(simulation.spawn("more", {std::nan(""), 0, 0, 0}), std::invalid_argument);
  EXPECT_THROW(simulation.remove(simulation.find("wall")), std::logic_error);

  const std::string plain =
      R"({"troupe": 1, "types": {"bot": {"size_m": [0.4, 0.4, 0.4], "drive": {"kind": "diff"}}},
                               "models": [{"name": "r", "type": "bot"}])";
  Simulation immortal(write("i.json", plain + "}"));
  EXPECT_THROW(immortal.remove(immortal.find("r")), std::logic_error);
  Simulation mortal(write("m.json", plain + R"(, "mortal": true})"));
  EXPECT_EQ(mortal.state_hash(), immortal.state_hash());
  mortal.remove(mortal.find("r"));
  EXPECT_EQ(mortal.robots(), 0u);
}

}  // namespace
}  // namespace troupe::lives_test
