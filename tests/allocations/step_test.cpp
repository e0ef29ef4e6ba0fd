// A warm step allocates nothing.

#include "tests/allocations/counting.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/troupe.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace troupe::step_test {
namespace {

using test::allocations_in;

TEST(Allocations, AreCounted) {
  std::vector<int> grows;
  EXPECT_EQ(allocations_in([&] { grows.resize(100); }), 1u);
  struct alignas(64) Line {
    char bytes[64];
  };
  std::vector<Line> lines;
  EXPECT_EQ(allocations_in([&] { lines.resize(3); }), 1u);
  EXPECT_EQ(allocations_in([&] { grows.resize(50); }), 0u);
}

TEST(Allocations, WhatIsNotFreedIsSeen) {
  const test::Live before = test::live();
  auto* kept = new std::vector<int>(1000);
  EXPECT_EQ(test::live().blocks, before.blocks + 2);
  EXPECT_GE(test::live().bytes, before.bytes + 4000);
  delete kept;
  EXPECT_EQ(test::live(), before);
}

// A run counts after `warm_ticks`, when all that grows has grown: where no floor plan says where robots will
// go, the index makes room as they go. Births and deaths fall into the ticks that count.
class WarmStep : public ::testing::TestWithParam<scenes::Run> {};
INSTANTIATE_TEST_SUITE_P(World, WarmStep, ::testing::ValuesIn(scenes::runs_of("allocations")),
                         [](const auto& run) { return run.param.name(); });

TEST_P(WarmStep, AllocatesNothing) {
  const scenes::Run& run = GetParam();
  for (const unsigned threads : {1u, 2u}) {
    SimulationOptions options;
    options.threads = threads;
    Simulation simulation(run.file(), options);
    const auto step = [&](std::uint64_t ticks) {
      for (std::uint64_t tick = 0; tick < ticks; ++tick) simulation.step();
    };
    step(test::k_slow_build ? 5 + run.warm_ticks / 20 : run.warm_ticks);
    // What a worker senses with is its own, and made when it first does: on a busy machine a second thread
    // may come late, or meet its first crowd late. One thread has no such excuse, unless a slow build has
    // hardly warmed up.
    std::size_t count = 0;
    for (int attempts = threads == 1 && !test::k_slow_build ? 1 : 10; attempts > 0; --attempts) {
      count = allocations_in([&] { step(test::k_slow_build ? 5 : run.ticks); });
      if (count == 0) break;
    }
    EXPECT_EQ(count, 0u) << threads << " threads";
  }
}

TEST(Allocations, ARobotThatOverlapsAWallNeedsNone) {
  Simulation simulation = Simulation::from_text(R"({
    "troupe": 1,
    "types": {
      "wall": {"size_m": [4, 0.2, 1]},
      "bot": {"blocks": [{"points_m": [[0, 0], [0.2, 0], [0.2, 0.4], [0, 0.4]], "z_m": [0, 0.2]},
                         {"points_m": [[0.2, 0], [0.4, 0], [0.4, 0.4], [0.2, 0.4]], "z_m": [0, 0.1]}],
              "size_m": [0.4, 0.4, 0.2], "drive": {"kind": "diff"}}
    },
    "models": [{"name": "wall", "type": "wall"}, {"name": "r", "type": "bot", "pose": {"y_m": 1}}]
  })",
                                                "walled.json", {.threads = 1});
  Model robot = simulation.find("r");
  robot.set_pose({0, 0.25, 0, 0});
  robot.set_speed(0.05, 0);
  for (int tick = 0; tick < 10; ++tick) simulation.step();
  EXPECT_EQ(allocations_in([&] {
              for (int tick = 0; tick < 10; ++tick) simulation.step();
            }),
            0u);
  EXPECT_NEAR(robot.pose().x, 0.1, 1e-9) << "the wall does not hold a robot that is in it";
}

}  // namespace
}  // namespace troupe::step_test
