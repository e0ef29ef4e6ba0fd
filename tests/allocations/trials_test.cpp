// Thousands of trials of one world, and many worlds one after another, in one process: the process returns
// all memory that they allocate.

#include "tests/allocations/counting.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/troupe.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <string_view>

namespace troupe::trials_test {
namespace {

/// A score of robots that look and wander among pillars, crowded enough that some have to wait for others.
constexpr std::string_view k_world = R"({
  "troupe": 1,
  "types": {
    "pillar": {"size_m": [0.5, 0.5, 1]},
    "bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}, "controller": {"kind": "wander"}, "sensors": [
      {"kind": "ranger", "pose": {"z_m": 0.1}, "transducers": [{"range_max_m": 2, "fov_deg": 90, "samples": 9}]}]}
  },
  "models": [
    {"name": "p0", "type": "pillar", "pose": {"x_m": 1}},
    {"name": "p1", "type": "pillar", "pose": {"x_m": -1}}
  ],
  "populations": [
    {"name": "r", "type": "bot", "count": 20, "place": {"rule": "uniform", "region_m": [[-2, -2], [2, 2]]}}
  ]
})";
constexpr std::uint64_t k_ticks = 5;  // a trial
constexpr std::size_t k_mebibyte = 1024 * 1024;

class Reset : public test::ScratchTest {
 protected:
  Simulation load(RangingEngine ranging, unsigned threads) const {
    SimulationOptions options;
    options.ranging = ranging;
    options.threads = threads;
    return Simulation(write("pillars.json", k_world), options);
  }

  static std::uint64_t trial(Simulation& simulation) {
    simulation.reset();
    for (std::uint64_t tick = 0; tick < k_ticks; ++tick) simulation.step();
    return simulation.state_hash();
  }
};

TEST_F(Reset, TenThousandLeakNothing) {
  constexpr int k_resets = test::k_slow_build ? 200 : 5000;  // with each engine
  for (const RangingEngine ranging : {RangingEngine::exact, RangingEngine::grid}) {
    Simulation simulation = load(ranging, 1);
    const std::uint64_t hash = trial(simulation);
    for (int warm = 0; warm < 10; ++warm) trial(simulation);
    const test::Live before = test::live();
    const std::size_t resident = test::resident_bytes();
    bool is_same = true;
    const std::size_t allocations = test::allocations_in([&] {
      for (int reset = 0; reset < k_resets; ++reset) is_same = trial(simulation) == hash && is_same;
    });
    EXPECT_TRUE(is_same) << "a trial ended in another state than the first";
    EXPECT_EQ(allocations, 0u);
    EXPECT_EQ(test::live(), before);
    if (!test::k_slow_build) {
      EXPECT_LT(test::resident_bytes(), resident + k_mebibyte);
    }
  }
}

TEST_F(Reset, OnTwoThreadsTheyLeakNothingEither) {
  constexpr int k_resets = test::k_slow_build ? 50 : 1000;
  Simulation simulation = load(RangingEngine::exact, 2);
  const std::uint64_t hash = trial(simulation);
  for (int warm = 0; warm < 100; ++warm) trial(simulation);
  const test::Live before = test::live();
  bool is_same = true;
  for (int reset = 0; reset < k_resets; ++reset) is_same = trial(simulation) == hash && is_same;
  EXPECT_TRUE(is_same);
  // What a worker senses with is its own, and made when it first does: a few blocks, once.
  EXPECT_LE(test::live().blocks, before.blocks + 50);
}

TEST_F(Reset, AHundredWorldsLeaveNothingBehind) {
  constexpr int k_worlds = test::k_slow_build ? 20 : 100;
  const auto live_and_die = [&](int world) {
    Simulation simulation = load(world % 2 == 0 ? RangingEngine::exact : RangingEngine::grid,
                                 1 + static_cast<unsigned>(world % 2));
    trial(simulation);
  };
  for (int warm = 0; warm < 6; ++warm) live_and_die(warm);
  const test::Live before = test::live();
  const std::size_t resident = test::resident_bytes();
  for (int world = 0; world < k_worlds; ++world) live_and_die(world);
  EXPECT_LE(test::live().blocks, before.blocks + 50);  // of workers that came late
  if (!test::k_slow_build) {
    EXPECT_LT(test::resident_bytes(), resident + 16 * k_mebibyte);
  }
}

TEST_F(Reset, AWorldThatCannotBeLoadedLeavesNothingBehind) {
  const auto file =
      write("bad.json", R"({"troupe": 1, "types": {"bot": {"size_m": [1, 1, 0]}}, "models": [3]})");
  const auto fail = [&] { EXPECT_THROW(Simulation simulation(file), InputError); };
  fail();
  const test::Live before = test::live();
  for (int attempt = 0; attempt < 20; ++attempt) fail();
  EXPECT_EQ(test::live(), before);
}

}  // namespace
}  // namespace troupe::trials_test
