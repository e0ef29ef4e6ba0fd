// Controllers that decide for all robots of a type in one call.
#include "engine/kinds/controller.hpp"
#include "engine/observing/controller_check.hpp"
#include "tests/support/scene.hpp"
#include "tests/support/slow_build.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>

namespace troupe::engine::collective_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Stores in each memory how many robots decide together and how far its robot is in the batch, and turns the
/// robots by the mean of their estimated headings, which depends on all of them.
struct Choir {
  struct Memory {
    std::uint32_t singers = 0;
    std::uint32_t place = 0;
    double mean = 0;
    TROUPE_FIELDS(singers, place, mean)
  };
  static constexpr bool needs_drive = true;

  void operator()(const DecideBatch& batch) const {
    double sum = 0;
    for (std::size_t i = 0; i < batch.size(); ++i) sum += batch.estimate(i).heading;  // depends on the order
    for (std::size_t i = 0; i < batch.size(); ++i) {
      auto& memory = *reinterpret_cast<Memory*>(batch.memory(i));
      memory = {static_cast<std::uint32_t>(batch.size()), static_cast<std::uint32_t>(i),
                sum / static_cast<double>(batch.size())};
      batch.command(i) = {0.1, 0, memory.mean};
    }
  }
};

const Registry& choir_registry() {
  static const Registry kinds = [] {
    Registry all = test::registry();
    for (const bool is_collective : {true, false}) {
      all.controllers.push_back(make_controller_kind<Choir>(is_collective ? "choir" : "soloists", "..."));
      all.controllers.back().is_collective = is_collective;
    }
    return all;
  }();
  return kinds;
}

constexpr std::size_t k_singers = 300;  // more than a task has

struct ChoirScene {
  Diagnostics diagnostics;
  World world;
  ChoirScene(const char* kind, unsigned threads, double tile_m = 0)
      : world(make(kind), choir_registry(), {.threads = threads, .tile_size_m = tile_m}, diagnostics) {}

  static WorldSpec make(const char* kind) {
    test::SceneBuilder scene;
    scene.spec.mortal = true;
    const TypeId bot = scene.robot("bot", {test::box(0.2, 0.2)});
    scene[bot].controllers.push_back({.kind = kind, .params = {}});
    for (std::size_t i = 0; i < k_singers; ++i)
      scene.body(fmt::format("r{}", i), bot,
                 {0.5 * static_cast<double>(i * 7 % 20), 0.5 * static_cast<double>(i / 20), 0,
                  0.01 * static_cast<double>(i)});
    return scene.spec;
  }
  const Choir::Memory& memory(std::size_t robot) {
    const Row row = world.view().row(BodyId(robot + 1));
    const BodyType& type = world.view().type(row);
    return world.tables()[*type.controllers[0].table].as<Choir::Memory>(world.view().slot(row));
  }
};

/// Remembers whether its robot is stalled, and the body that blocks it.
struct Feels {
  static constexpr bool reads_contacts = true;
  struct Memory {
    bool stalled = false;
    std::uint32_t by = 0;
    TROUPE_FIELDS(stalled, by)
  };
  void operator()(Memory& memory, const Percept& percept, Random&, Actions& actions) const {
    memory = {percept.stalled, percept.blocked_by.body};
    actions.set_speed(1, 0, 0);
  }
};

TEST(Controller, ReadsWhatBlockedItsRobot) {
  Registry registry = choir_registry();
  registry.controllers.push_back(make_controller_kind<Feels>("feels", "..."));
  test::SceneBuilder scene;
  const TypeId bot = scene.robot("bot", {test::box(0.2, 0.2)});
  scene[bot].controllers.push_back({.kind = "feels", .params = {}});
  const std::vector<BodyId> bots{scene.body("first", bot), scene.body("second", bot, {0, 3, 0, 0}),
                                 scene.body("third", bot, {0, 6, 0, 0})};
  const std::vector<BodyId> walls{scene.wall(0.35, -1, 0.5, 1), scene.wall(0.35, 2, 0.5, 4),
                                  scene.wall(0.35, 5, 0.5, 7)};
  Diagnostics diagnostics;
  World world(scene.spec, registry, {.threads = 1}, diagnostics);
  std::vector<std::vector<std::pair<bool, std::uint32_t>>> seen(bots.size());
  for (int tick = 0; tick < 5; ++tick) {
    world.step();
    for (std::size_t i = 0; i < bots.size(); ++i) {
      const Row row = world.view().row(bots[i]);
      const StateTable& memories = world.tables()[*world.view().type(row).controllers[0].table];
      const auto& memory = memories.as<Feels::Memory>(world.view().slot(row));
      seen[i].emplace_back(memory.stalled, memory.by);
    }
  }
  // Each moves in tick 2 and 3, by 0.1 m each, and is blocked from tick 4 on.
  const std::pair<bool, std::uint32_t> free(false, 0);
  for (std::size_t i = 0; i < bots.size(); ++i)
    EXPECT_THAT(seen[i], ::testing::ElementsAre(free, free, free, free, std::pair(true, walls[i].value + 1)));
}

/// As Choir, but first makes a step of another world.
struct Rehearsal : Choir {
  void operator()(const DecideBatch& batch) const {
    other->step();
    Choir::operator()(batch);
  }
  static inline World* other = nullptr;
};

TEST(Collective, MayMakeAStepOfAnotherWorld) {
  ChoirScene other("choir", 1);
  Rehearsal::other = &other.world;
  Registry registry = choir_registry();
  registry.controllers.push_back(make_controller_kind<Rehearsal>("rehearsal", "..."));
  registry.controllers.back().is_collective = true;
  test::SceneBuilder scene;  // fewer robots than the other world
  const TypeId bot = scene.robot("bot", {test::box(0.2, 0.2)});
  scene[bot].controllers.push_back({.kind = "rehearsal", .params = {}});
  for (int i = 0; i < 3; ++i) scene.body(fmt::format("r{}", i), bot, {1.0 * i, 0, 0, 0});
  Diagnostics diagnostics;
  World world(scene.spec, registry, {.threads = 1}, diagnostics);
  for (int tick = 0; tick < 3; ++tick) {
    world.step();
    const StateTable& memories = world.tables()[*world.view().type(Row(0)).controllers[0].table];
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& memory = memories.as<Choir::Memory>(world.view().slot(world.view().row(BodyId(i + 1))));
      EXPECT_EQ(memory.singers, 3u);
      EXPECT_EQ(memory.place, i);
    }
  }
}

TEST(Collective, DecidesForAllRobotsOfATypeInTheOrderOfTheirIds) {
  ChoirScene scene("choir", 2);
  scene.world.step();
  for (std::size_t i = 0; i < k_singers; ++i) {
    EXPECT_EQ(scene.memory(i).singers, k_singers);
    EXPECT_EQ(scene.memory(i).place, i);
  }
  ChoirScene soloists("soloists", 2);
  soloists.world.step();
  EXPECT_LT(soloists.memory(0).singers, k_singers) << "the same class that decides in tasks";
}

TEST(Collective, LeavesOutRobotsThatAreDisabled) {
  ChoirScene scene("choir", 2);
  EXPECT_TRUE(scene.world.set_disabled(scene.world.view().row(BodyId(3)), true));
  scene.world.step();
  EXPECT_EQ(scene.memory(0).singers, k_singers - 1);
  EXPECT_EQ(scene.memory(2).singers, 0u);
  EXPECT_EQ(scene.memory(3).place, 2u);
}

TEST(Collective, LooksAtEachBodyOnceHoweverManyTypesThereAre) {
  constexpr std::size_t k_types = 1'000;
  constexpr std::uint32_t k_unborn = 200'000;
  test::SceneBuilder scene;
  for (std::size_t i = 0; i < k_types; ++i) {
    const TypeId type = scene.robot(fmt::format("bot{}", i), {test::box(0.2, 0.2)});
    scene[type].controllers.push_back({.kind = "choir", .params = {}});
    scene.body(fmt::format("r{}", i), type, {static_cast<double>(i % 40), static_cast<double>(i / 40), 0, 0});
  }
  scene.spec.reserves.push_back({"r", BodyId(scene.spec.bodies.size()), k_unborn});
  for (std::uint32_t i = 0; i < k_unborn; ++i) scene.body(fmt::format("r{}", k_types + i), TypeId(1));
  Diagnostics diagnostics;
  World world(scene.spec, choir_registry(), {.threads = 1}, diagnostics);
  for (int tick = 0; tick < (test::k_slow_build ? 5 : 200); ++tick) world.step();
  for (std::size_t i = 0; i < k_types; ++i)
    ASSERT_EQ(world.view().commands()[world.view().row(BodyId(i + 1)).index()].x, 0.1);
}

TEST(Collective, HasTheSameBitsWithAnyThreadsAndTiles) {
  ChoirScene expected("choir", 1);
  ChoirScene other("choir", 3, 1.5);
  for (int tick = 0; tick < 20; ++tick) {
    expected.world.step();
    other.world.step();
    ASSERT_EQ(expected.world.hashes().state, other.world.hashes().state) << tick;
  }
}

TEST(Collective, IsRepeatedAsAWhole) {
  ChoirScene scene("choir", 2);
  ControllerCheck check(scene.world, choir_registry());
  for (int tick = 0; tick < 3; ++tick) {
    scene.world.step();
    EXPECT_THAT(check.repeat(), IsEmpty());
  }
  EXPECT_EQ(check.decisions(), 3 * k_singers);
}

}  // namespace
}  // namespace troupe::engine::collective_test
