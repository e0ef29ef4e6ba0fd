// A warm step allocates nothing.

#include "tests/allocations/counting.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/troupe.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

namespace troupe {
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

struct Scene {
  std::string name;
  std::string world;
  std::uint64_t warm;   ///< ticks until all that grows has grown
  std::uint64_t ticks;  ///< counted
};

class WarmStep : public ::testing::TestWithParam<Scene> {};
INSTANTIATE_TEST_SUITE_P(
    World, WarmStep,
    ::testing::Values(
        Scene{"hospital", "hospital.json", 20, 100},
        Scene{"caveWithLasers", "cave-complex-laser.json", 20, 100}, Scene{"crowd", "crowd.json", 100, 100},
        // No floor plan says where they will go: the index makes room as they do.
        Scene{"errands", "errands.json", 400, 100}, Scene{"energy", "energy.json", 400, 200},
        Scene{"foraging", "foraging.json", 20, 800}, Scene{"gripper", "gripper.json", 195, 200},
        Scene{"gate", "gate.json", 20, 200}, Scene{"magpies", "magpies.json", 400, 200},
        Scene{"lookout", "lookout.json", 200, 100}, Scene{"chatter", "chatter.json", 200, 100},
        Scene{"perception", "perception.json", 100, 200}, Scene{"blobs", "blobs.world", 10, 20},
        Scene{"beeclust", "beeclust.json", 100, 200}, Scene{"chain", "chain.json", 100, 200},
        Scene{"brazilNut", "brazil_nut.json", 100, 200}, Scene{"segregation", "segregation.json", 100, 200},
        Scene{"bumper", "bumper.world", 10, 50}, Scene{"camera", "camera.world", 10, 50},
        Scene{"noise", "noise.world", 10, 50},
        // Births and deaths fall into what is counted.
        Scene{"colony", "colony.json", 600, 600}, Scene{"pucks", "pucks.json", 1500, 300},
        Scene{"harvest", "harvest.json", 400, 300}, Scene{"door", "door.json", 150, 100},
        Scene{"failures", "failures.json", 100, 170}, Scene{"clustering", "clustering.json", 400, 400}),
    [](const auto& scene) { return scene.param.name; });

TEST_P(WarmStep, AllocatesNothing) {
  const Scene& scene = GetParam();
  for (const unsigned threads : {1u, 2u}) {
    SimulationOptions options;
    options.threads = threads;
    Simulation simulation(std::filesystem::path(TROUPE_SOURCE_DIR) / "worlds" / scene.world, options);
    const auto step = [&](std::uint64_t ticks) {
      for (std::uint64_t tick = 0; tick < ticks; ++tick) simulation.step();
    };
    step(test::k_slow_build ? 5 + scene.warm / 20 : scene.warm);
    // What a worker senses with is its own, and made when it first does: on a busy machine a second thread
    // may come late, or meet its first crowd late. One thread has no such excuse.
    std::size_t count = 0;
    for (int attempts = threads == 1 ? 1 : 10; attempts > 0; --attempts) {
      count = allocations_in([&] { step(test::k_slow_build ? 5 : scene.ticks); });
      if (count == 0) break;
    }
    EXPECT_EQ(count, 0u) << threads << " threads";
  }
}

}  // namespace
}  // namespace troupe
