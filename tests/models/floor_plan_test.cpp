#include "models/controllers/floor_plan.hpp"

#include "base/random.hpp"
#include "tests/support/scene.hpp"
#include "tests/support/slow_build.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <limits>
#include <vector>

namespace troupe::models::floor_plan_test {
namespace {

constexpr int k_cells = FloorPlan::k_cells;
const Box k_box = Box::around(Vec2::Zero(), 8);

FloorPlan random_plan(std::uint32_t seed) {
  Random random(seed, 1, 2, 3);
  FloorPlan plan(k_box);
  for (int cell = 0; cell < plan.size(); ++cell)
    if (random.uniform() < 0.4) plan.block(cell);
  return plan;
}

/// What ways cost from everywhere to the nearest goal, by relaxing until nothing changes.
std::vector<int> costs(const FloorPlan& plan, const std::vector<int>& goals) {
  std::vector<int> cost(static_cast<std::size_t>(plan.size()), 1000000);
  for (const int goal : goals) cost[static_cast<std::size_t>(goal)] = 0;
  for (bool changed = true; changed;) {
    changed = false;
    for (int from = 0; from < plan.size(); ++from)
      for (const int to : {from - 1, from + 1, from - k_cells, from + k_cells}) {
        if (to < 0 || to >= plan.size() || std::abs(to % k_cells - from % k_cells) > 1) continue;
        const int there =
            cost[static_cast<std::size_t>(to)] + (plan.blocked(to) ? k_blocked_cost : k_free_cost);
        if (there >= cost[static_cast<std::size_t>(from)]) continue;
        cost[static_cast<std::size_t>(from)] = there;
        changed = true;
      }
  }
  return cost;
}

TEST(FloorPlan, WaysCostAsLittleAsCanBe) {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const FloorPlan plan = random_plan(seed);
    const std::vector<int> goals{3, 700};
    const std::vector<int> least = costs(plan, goals);
    const WaysTo ways(plan, goals);
    for (int from = 0; from < plan.size(); from += test::k_slow_build ? 31 : 1) {
      int cost = 0;
      int cell = from;
      for (int steps = 0; ways.next(cell) != cell; ++steps) {
        ASSERT_LT(steps, plan.size());
        cell = ways.next(cell);
        cost += plan.blocked(cell) ? k_blocked_cost : k_free_cost;
      }
      EXPECT_TRUE(cell == goals[0] || cell == goals[1]);
      EXPECT_EQ(cost, least[static_cast<std::size_t>(from)]) << from;
    }
  }
}

TEST(FloorPlan, IsTheRasterOfAModelWhereItStands) {
  test::SceneBuilder scene;
  // 4 m wide about (10, 0): a cell is 0.125 m. A slab fills its left quarter, a pillar marks the far corner.
  const TypeId type = scene.type("map", {Solid{{test::rectangle(-2, -2, -1, 2)}, {0, 1}},
                                         Solid{{test::rectangle(1.9, 1.9, 2, 2)}, {0, 1}}});
  const BodyId body = scene.body("map", type, {10, 0, 0, 0});
  const FloorPlan plan = FloorPlan::of_body(scene.spec, body);
  int blocked = 0;
  for (int cell = 0; cell < plan.size(); ++cell) blocked += plan.blocked(cell);
  EXPECT_EQ(blocked, 8 * k_cells + 1);
  EXPECT_TRUE(plan.blocked(plan.cell({8.5, 0})));
  EXPECT_FALSE(plan.blocked(plan.cell({9.1, 0})));
  EXPECT_TRUE(plan.blocked(plan.cell({99, 99})));  // outside is at the border
  EXPECT_NEAR(plan.center(plan.cell({9.1, 0.1})).x(), 9.0625, 1e-12);
}

// The estimated pose of a robot is not a number if its odometry overflows.
TEST(FloorPlan, EveryPointHasACell) {
  const FloorPlan plan(k_box);
  constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double k_far = std::numeric_limits<double>::infinity();
  EXPECT_EQ(plan.cell({k_nan, k_nan}), 0);
  EXPECT_EQ(plan.cell({k_far, k_nan}), k_cells - 1);
  EXPECT_EQ(plan.cell({-k_far, k_far}), k_cells * (k_cells - 1));
  EXPECT_EQ(plan.cell({8, 8}), plan.size() - 1);
  EXPECT_EQ(plan.cell({-8, 8 - 1e-9}), k_cells * (k_cells - 1));
}

TEST(FloorPlan, WaysLeadRoundAWall) {
  FloorPlan plan(k_box);
  for (int y = 0; y < k_cells - 1; ++y) plan.block(y * k_cells + 16);  // open at the top
  const std::array<int, 1> goal{31};
  const std::vector<int> way = find_way(plan, 10, goal);
  EXPECT_EQ(way.front(), 10);
  EXPECT_EQ(way.back(), 31);
  // Through the wall: 21 cells, one of them blocked: 29. Round it: 83.
  EXPECT_EQ(way.size(), 22);
  for (int y = 0; y < k_cells - 1; ++y) plan.block(y * k_cells + 17), plan.block(y * k_cells + 18);
  for (int x = 19; x < 31; ++x)
    for (int y = 0; y < 12; ++y) plan.block(y * k_cells + x);
  EXPECT_GT(find_way(plan, 10, goal).size(), 22);  // twelve more blocked cells: round those
}

TEST(FloorPlan, BodiesAreFoundByTheirNamesAndGeneratedOnes) {
  test::SceneBuilder scene;
  const BodyId body = scene.body("cave", scene.type("t", {test::box(1, 1)}));
  scene.spec.aliases.push_back({scene.spec.names.add("model:1"), body});
  EXPECT_EQ(find_body(scene.spec, "cave"), body);
  EXPECT_EQ(find_body(scene.spec, "model:1"), body);
  EXPECT_FALSE(find_body(scene.spec, "cavern").valid());
}

}  // namespace
}  // namespace troupe::models::floor_plan_test
