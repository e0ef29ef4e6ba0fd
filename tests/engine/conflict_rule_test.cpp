#include "tests/engine/conflict_crowds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>

namespace troupe::oracle::conflict_rule_test {
namespace {

using engine::Conflicts;
using Outcome = Conflicts::Outcome;

constexpr std::array<unsigned, 4> k_threads{1, 2, 3, 8};
constexpr std::array<partition::GridGeometry, 4> k_grids{{{0.25, 4}, {1, 3}, {7, 0}, {0.6, 6}}};
constexpr std::array<double, 3> k_scene_cells{0.3, 1.1, 6};

/// Four teams of threads and their Conflicts, kept: what one crowd left behind must not show in the next.
struct Teams {
  std::vector<partition::Parallel> parallel;
  std::array<Conflicts, k_threads.size()> conflicts;
  Teams() {
    for (const unsigned threads : k_threads) parallel.emplace_back(threads);
  }
};

struct Tally {
  std::size_t crowds = 0;
  std::size_t moving = 0;
  std::size_t blocked = 0;
  std::size_t out_of_bounds = 0;
  std::size_t turned = 0;
  std::size_t order_matters = 0;  ///< crowds in which another order has another outcome
  std::size_t deep = 0;           ///< crowds in which a body waited for one that waited
  std::uint64_t deepest = 0;
};

void compare(const TestCrowd& crowd, Teams& teams, Tally& tally) {
  std::vector<engine::Contact> contacts;
  const std::vector<Outcome> expected = resolve(crowd.question(), true, &contacts);
  std::uint64_t rounds = 0;
  for (std::size_t t = 0; t < k_threads.size(); ++t) {
    const partition::GridGeometry& grid = k_grids[(tally.crowds + t) % k_grids.size()];
    const double cell = k_scene_cells[(tally.crowds + t) % k_scene_cells.size()];
    std::vector<engine::FreeCircle> free;
    std::vector<Conflicts::Block> blocks;
    const std::vector<Outcome> got = resolve(crowd, scene_of(crowd, cell), grid, teams.parallel[t],
                                             teams.conflicts[t], free, {}, nullptr, &blocks);
    for (std::size_t i = 0; i < crowd.size(); ++i) {
      ASSERT_EQ(static_cast<int>(got[i]), static_cast<int>(expected[i]))
          << "body " << i << " of " << crowd.size() << ", " << k_threads[t] << " threads, cells of "
          << grid.cell_m;
      ASSERT_EQ(blocks[i].contact.cause, contacts[i].cause) << "body " << i;
      ASSERT_EQ(blocks[i].contact.body, contacts[i].body) << "body " << i;
    }
    ASSERT_TRUE(t == 0 || teams.conflicts[t].rounds() == rounds) << k_threads[t] << " threads";
    rounds = teams.conflicts[t].rounds();
  }
  ++tally.crowds;
  for (const Motion& m : crowd.motions) tally.moving += m.moves;
  tally.blocked += static_cast<std::size_t>(std::ranges::count(expected, Outcome::blocked));
  tally.out_of_bounds += static_cast<std::size_t>(std::ranges::count(expected, Outcome::out_of_bounds));
  tally.turned += static_cast<std::size_t>(std::ranges::count(expected, Outcome::turned));
  tally.deep += rounds > 2;
  tally.deepest = std::max(tally.deepest, rounds);
  tally.order_matters += expected != resolve(crowd.question(), false);
}

void report(const Tally& tally) {
  std::printf(
      "%zu crowds, %zu motions, %.1f %% blocked, %zu out of bounds; the order matters in %zu; a body waited "
      "for one "
      "that waited in %zu, "
      "longest chain %zu\n",
      tally.crowds, tally.moving,
      100.0 * static_cast<double>(tally.blocked) / static_cast<double>(tally.moving), tally.out_of_bounds,
      tally.order_matters, tally.deep, static_cast<std::size_t>(tally.deepest - 1));
}

TEST(ConflictRule, ThousandsOfSmallCrowdsAreResolvedAsTheRuleSays) {
  Teams teams;
  Tally tally;
  for (std::uint64_t seed = 1; seed <= (k_thrift > 1 ? 60 : 2500); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Draw draw(seed);
    TestCrowd crowd = random_crowd(draw, {.most_bodies = 5 + draw.below(60),
                                          .fill = draw.real(0.4, 1.2),
                                          .small = draw.chance(0.5) ? 0.05 : 0.3,
                                          .large = draw.chance(0.5) ? 0.5 : 3,
                                          .overlapping = draw.chance(0.3) ? 0.1 : 0,
                                          .walls = draw.chance(0.5) ? draw.below(8) : 0,
                                          .region = draw.chance(0.3),
                                          .bounded = draw.chance(0.2)});
    random_motions(crowd, draw, 60);
    if (seed % 3 == 0) crowd.draw_turns(draw);
    compare(crowd, teams, tally);
    if (HasFatalFailure()) return;
  }
  report(tally);
  EXPECT_GT(100 * tally.blocked, tally.moving) << "too easy: under 1 % are blocked";
  EXPECT_GT(tally.out_of_bounds, 0u);
  EXPECT_GT(tally.turned, tally.crowds / 10);
  EXPECT_GT(4 * tally.order_matters, tally.crowds);
}

TEST(ConflictRule, LargeCrowdsWithLongChainsAreResolvedAsTheRuleSays) {
  constexpr std::size_t k_fewer = test::k_slow_build ? 4 : 1;  // the oracle looks at all pairs
  Teams teams;
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 40 / k_thrift; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Draw draw(1'000'000 + seed);
    TestCrowd crowd = random_crowd(draw, {.most_bodies = (300 + draw.below(700)) / k_fewer,
                                          .fill = draw.real(0.5, 1.2),
                                          .small = draw.chance(0.5) ? 0.05 : 0.2,
                                          .large = draw.chance(0.5) ? 0.4 : 3,
                                          .overlapping = draw.chance(0.3) ? 0.05 : 0,
                                          .walls = draw.chance(0.5) ? draw.below(40) : 0,
                                          .region = draw.chance(0.3),
                                          .bounded = draw.chance(0.2)});
    random_motions(crowd, draw, 30);
    if (seed % 3 == 0) crowd.draw_turns(draw);
    compare(crowd, teams, tally);
    if (HasFatalFailure()) return;
  }
  report(tally);
  EXPECT_GT(100 * tally.blocked, tally.moving) << "too easy: under 1 % are blocked";
  EXPECT_EQ(tally.order_matters, tally.crowds);
  EXPECT_GT(2 * k_fewer * tally.deep, tally.crowds) << "too easy: few wait for a waiting robot";
}

// Bodies of whole millimetres on a lattice of their own width touch on all sides, and touching is free: a row
// can slide along its neighbours. (Powers of two, so that no vertex is rounded.)
TEST(ConflictRule, TouchingIsFree) {
  Teams teams;
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 50 / k_thrift; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Draw draw(2'000'000 + seed);
    TestCrowd crowd;
    crowd.seed = seed;
    crowd.kinds.push_back(make_kind({{{rectangle(-0.25, -0.25, 0.25, 0.25)}, {0, 1}}}));
    crowd.walls.push_back({{rectangle(-0.25, -0.5, 8, -0.25)}, {0, 1}});
    for (int y = 0; y < 12; ++y)
      for (int x = 0; x < 12; ++x)
        if (draw.chance(0.7)) crowd.add(crowd.kinds[0], {0.5 * x, 0.5 * y, 0, 0});
    constexpr std::array<std::array<double, 2>, 4> k_ways{{{0.5, 0}, {-0.5, 0}, {0, 0.5}, {0, -0.5}}};
    for (Motion& m : crowd.motions) {
      const auto& way = k_ways[draw.below(4)];
      m.moves = true;
      m.to.x += way[0];
      m.to.y += way[1];
    }
    compare(crowd, teams, tally);
    if (HasFatalFailure()) return;
  }
  report(tally);
  EXPECT_LT(tally.blocked, tally.moving);
  EXPECT_GT(tally.blocked, 0u);
}

TEST(ConflictRule, WhoIsFirstChangesFromTickToTick) {
  partition::Parallel parallel(1);
  Conflicts conflicts;
  TestCrowd crowd;
  crowd.kinds.push_back(make_kind({{{rectangle(-0.1, -0.1, 0.1, 0.1)}, {0, 1}}}));
  crowd.add(crowd.kinds[0], {-0.3, 0, 0, 0});
  crowd.add(crowd.kinds[0], {0.3, 0, 0, 0});
  for (Motion& m : crowd.motions) {
    m.to.x = 0;
    m.moves = true;
  }
  const partition::StaticScene nothing;
  int first_wins = 0;
  int changes = 0;
  bool before = false;
  constexpr int k_ticks = 2000;
  for (crowd.tick = 0; crowd.tick < k_ticks; ++crowd.tick) {
    const std::vector<Outcome> outcomes = resolve(crowd, nothing, {1, 3}, parallel, conflicts);
    const bool first = outcomes[0] == Outcome::moved;
    ASSERT_NE(first, outcomes[1] == Outcome::moved) << "one of them wins";
    first_wins += first;
    changes += crowd.tick > 0 && first != before;
    before = first;
  }
  // A fair coin stays within these bounds (4.5 standard deviations).
  EXPECT_NEAR(first_wins, k_ticks / 2, 100);
  EXPECT_NEAR(changes, k_ticks / 2, 100);
}

}  // namespace
}  // namespace troupe::oracle::conflict_rule_test
