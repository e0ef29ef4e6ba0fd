#include "tests/support/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

/// Bodies put elsewhere between ticks.
namespace troupe::engine::placing_test {
namespace {

struct Pair {
  explicit Pair(double second_x = 3, const char* localization = "gps") {
    const TypeId type = scene.robot("robot", {Solid{{test::box_ring(0.4, 0.4)}, {0, 1}}});
    scene[type].drive = test::drive("diff", {{"localization", localization}});
    scene[type].devices.push_back(test::ranger("eye", {{.range_max = 5}}));
    first = scene.body("a", type);
    second = scene.body("b", type, {second_x, 0, 0, 0});
    scene.wall(6, -2, 7, 2);
    scene.spec.bounds = Box{{-10, -10}, {10, 10}};
  }
  test::SceneBuilder scene;
  BodyId first, second;
};

float reading(const World& world, BodyId body) {
  const Row row = world.view().row(body);
  return world.tables()[world.view().type(row).devices[0].table].cell<float>(world.view().slot(row), 0)[0];
}

TEST(Placing, IsSeenByOthersAndGoesOnFromThere) {
  Pair pair;
  World world = pair.scene.world();
  world.step();
  EXPECT_FLOAT_EQ(reading(world, pair.first), 2.8f);
  const World::Placed placed{world.view().row(pair.second), {1, 0, 0, 3 * k_pi}};
  world.set_poses({&placed, 1});
  EXPECT_EQ(world.view().pose(pair.second).x, 1);
  EXPECT_NEAR(std::abs(world.view().pose(pair.second).heading), k_pi, 1e-12);
  world.set_command(world.view().row(pair.second), {0.5, 0, 0});
  world.step();
  EXPECT_FLOAT_EQ(reading(world, pair.first), 0.8f);
  EXPECT_NEAR(world.view().pose(pair.second).x, 0.95, 1e-12);
}

TEST(Placing, GivesWhatAWorldThatBeganThereGives) {
  // A robot that knew free ground about its old place must look for walls at the new one.
  Pair pair;
  World world = pair.scene.world();
  for (int i = 0; i < 3; ++i) world.step();
  const World::Placed placed[]{{world.view().row(pair.first), {5.6, 0, 0, 0}},
                               {world.view().row(pair.second), {-4, 1, 0, 1}}};
  world.set_poses(placed);
  Pair other;
  other.scene.spec.bodies[other.first.index()].pose_world_body = {5.6, 0, 0, 0};
  other.scene.spec.bodies[other.second.index()].pose_world_body = {-4, 1, 0, 1};
  World fresh = other.scene.world();
  for (World* w : {&world, &fresh}) {
    w->set_command(w->view().row(pair.first), {0.9, 0, 0});
    w->set_command(w->view().row(pair.second), {0.9, 0, 0.3});
    for (int i = 0; i < 5; ++i) w->step();
  }
  for (const BodyId body : {pair.first, pair.second}) {
    EXPECT_EQ(world.view().pose(body), fresh.view().pose(body));
    EXPECT_EQ(reading(world, body), reading(fresh, body));
    EXPECT_EQ(world.view().stalled(world.view().row(body)), fresh.view().stalled(fresh.view().row(body)));
  }
  EXPECT_TRUE(world.view().stalled(world.view().row(pair.first)));
}

TEST(Placing, IsNoMotion) {
  Pair pair(3, "odom");
  World world = pair.scene.world();
  const Row row = world.view().row(pair.first);
  world.set_command(row, {0.5, 0, 0});
  world.step();
  const Pose estimate = world.view().estimate(row);
  const World::Placed placed{row, {-5, 5, 0, 1}};
  world.set_poses({&placed, 1});
  EXPECT_EQ(world.view().estimate(row), estimate);
  EXPECT_EQ(world.view().velocities()[row.index()].x, 0.5);
  world.step();
  EXPECT_NEAR(world.view().estimate(row).x, 2 * estimate.x, 1e-3);
}

TEST(Placing, WhoWasStalledNoLongerIs) {
  Pair pair(0.41);
  World world = pair.scene.world();
  const Row row = world.view().row(pair.first);
  world.set_command(row, {0.5, 0, 0});
  world.step();
  ASSERT_TRUE(world.view().stalled(row));
  ASSERT_EQ(world.view().counts().stalled, 1u);
  const World::Placed placed{row, {-5, 5, 0, 1}};
  world.set_poses({&placed, 1});
  EXPECT_FALSE(world.view().stalled(row));
  EXPECT_EQ(world.view().counts().stalled, 0u);
}

TEST(Placing, BodiesThatOverlapMayMoveApart) {
  Pair pair;
  World world = pair.scene.world();
  const Row row = world.view().row(pair.first);
  const World::Placed placed{row, {2.9, 0, 0, 0}};
  world.set_poses({&placed, 1});
  world.set_command(row, {0.5, 0, 0});  // deeper
  world.step();
  EXPECT_TRUE(world.view().stalled(row));
  world.set_command(row, {-0.5, 0, 0});
  world.step();
  EXPECT_FALSE(world.view().stalled(row));
  EXPECT_NEAR(world.view().pose(pair.first).x, 2.85, 1e-12);
}

TEST(Placing, IsFreeTellsWhoseWayItWouldBe) {
  Pair pair;
  const World world = pair.scene.world();
  const Row row = world.view().row(pair.first);
  EXPECT_TRUE(world.is_free(row, {0.1, 0, 0, 0.3}));  // itself does not count
  EXPECT_TRUE(world.is_free(row, {2.5, 0, 0, 0}));
  EXPECT_FALSE(world.is_free(row, {2.61, 0, 0, 0}));  // the other
  EXPECT_TRUE(world.is_free(row, {5.75, 0, 0, 0}));
  EXPECT_FALSE(world.is_free(row, {5.81, 0, 0, 0}));  // the wall
  EXPECT_FALSE(world.is_free(row, {6.5, 0, 0, 0}));   // within it
  EXPECT_FALSE(world.is_free(row, {11, 0, 0, 0}));    // outside the world
  EXPECT_TRUE(world.is_free(row, {3, 0, 1.5, 0}));    // above
  EXPECT_FALSE(world.is_free(row, {std::nan(""), 0, 0, 0}));
}

TEST(Placing, RefusesAnInvalidPlaceAndThenMovesNoRobot) {
  Pair pair;
  World world = pair.scene.world();
  const std::uint64_t before = world.hashes().state;
  const auto refusal = [&](const Pose& pose) -> std::string {
    const World::Placed placed[]{{world.view().row(pair.second), {-5, 0, 0, 0}},
                                 {world.view().row(pair.first), pose}};
    try {
      world.set_poses(placed);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal({11, 0, 0, 0}),
            "\"a\" cannot be placed at x 11, y 0, z 0 (m), heading 0 (rad): outside the world's bounds (x "
            "-10 to 10, y -10 to 10 m)");
  EXPECT_EQ(refusal({0, std::numeric_limits<double>::infinity(), 0, 0}),
            "\"a\" cannot be placed at x 0, y inf, z 0 (m), heading 0 (rad): the numbers must be finite");
  EXPECT_EQ(world.hashes().state, before);
}

}  // namespace
}  // namespace troupe::engine::placing_test
