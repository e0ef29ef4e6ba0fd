#include "sensors/bumper.hpp"

#include "engine/kinds/sensor_params.hpp"
#include "tests/support/scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace troupe::sensors::bumper_test {
namespace {

using engine::World;
using test::box;
using test::SceneBuilder;
using ::testing::ElementsAre;

/// A robot of 0.4 m with a strip of 0.3 m before it and one behind it, each 1 cm off.
struct BumperScene : SceneBuilder {
  explicit BumperScene(const Pose& pose = {}) {
    const TypeId type = robot("robot", {box(0.4, 0.4)});
    const engine::BumperParams params{.bumpers = {{{0.21, 0, 0, 0}, 0.3}, {{-0.21, 0, 0, k_pi}, 0.3}}};
    (*this)[type].devices = {
        {.name = "bumper", .kind = "bumper", .params = engine::to_record(params), .where = {}}};
    body("r", type, pose);
  }
};

struct Felt {
  std::vector<int> hits;
  std::vector<std::uint32_t> bodies;
};

Felt felt(World& world) {
  world.step();
  const Row row = world.view().row(BodyId(1));
  const engine::StateTable& table = world.tables()[world.view().type(row).devices[0].table];
  const auto hits = table.cell<std::uint8_t>(world.view().slot(row), k_bumper_hit);
  const auto bodies = table.cell<std::uint32_t>(world.view().slot(row), k_bumper_body);
  return {{hits.begin(), hits.end()}, {bodies.begin(), bodies.end()}};
}

TEST(Bumper, ARobotThatDrivesIntoAWallFeelsIt) {
  BumperScene scene;
  const BodyId wall = scene.wall(1.005, -2, 1.2, 2);
  World world = scene.world();
  world.set_command(world.view().row(BodyId(1)), {.x = 1});
  int first_hit = 0;
  for (int tick = 1; tick <= 20 && first_hit == 0; ++tick)
    if (felt(world).hits[0] != 0) first_hit = tick;
  // The drive of tick 1 moves it in that tick: after tick n it stands at 0.1 n. Its front is at the wall's
  // face, less 5 mm, after tick 8, which tick 9 is the first to sense.
  EXPECT_EQ(first_hit, 9);
  for (int tick = 0; tick < 5; ++tick) {
    const Felt now = felt(world);
    EXPECT_THAT(now.hits, ElementsAre(1, 0));
    EXPECT_THAT(now.bodies, ElementsAre(wall.value, 0u));
  }
  EXPECT_TRUE(world.view().stalled(world.view().row(BodyId(1))));
}

TEST(Bumper, FeelsOtherRobotsOfAnyHeightButNotItself) {
  BumperScene scene({0, 0, 0, k_pi / 2});
  const TypeId other = scene.robot("other", {box(0.2, 0.2, 0.05)});
  const BodyId o = scene.body("o", other, {0.1, -0.305, 0, 0.0});
  World world = scene.world();
  const Felt now = felt(world);
  EXPECT_THAT(now.hits, ElementsAre(0, 1));
  EXPECT_THAT(now.bodies, ElementsAre(0u, o.value));
}

TEST(Bumper, EndsWhereItsLengthEnds) {
  BumperScene scene;
  scene.wall(0.205, 0.171, 0.3, 0.5);
  World beyond = scene.world();
  EXPECT_THAT(felt(beyond).hits, ElementsAre(0, 0));
  scene.wall(0.205, 0.169, 0.3, 0.5);
  World within = scene.world();
  EXPECT_THAT(felt(within).hits, ElementsAre(1, 0));
}

TEST(Bumper, FeelsUpToItsThicknessAndNamesTheLowerOfTwoAtOneDistance) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  const engine::BumperParams params{.bumpers = {{{0.25, 0, 0, 0}, 0.5}}, .thickness = 0.0625};
  scene[type].devices = {{.name = "bumper", .kind = "bumper", .params = engine::to_record(params)}};
  scene.body("r", type);
  SceneBuilder beyond = scene;
  beyond.wall(0.31251, -1, 1, 1);
  World apart = beyond.world();
  EXPECT_THAT(felt(apart).hits, ElementsAre(0));
  const TypeId crate = scene.robot("crate", {box(0.125, 0.125)});
  for (const bool wall_first : {true, false}) {
    SceneBuilder two = scene;
    if (wall_first) two.wall(0.3125, 0, 1, 1);
    two.body("crate", crate, {0.375, -0.125, 0, 0});
    if (!wall_first) two.wall(0.3125, 0, 1, 1);
    World world = two.world();
    const Felt now = felt(world);
    EXPECT_THAT(now.hits, ElementsAre(1));
    EXPECT_THAT(now.bodies, ElementsAre(2u)) << wall_first;
  }
}

TEST(Bumper, FeelsAnEdgeThatCrossesItsStrip) {
  // No end of an edge is near the strip, and no end of the strip is near an edge.
  BumperScene scene;
  const BodyId beam = scene.wall(-1, -0.05, 2, 0.05, {.obstacle = false});
  World world = scene.world();
  EXPECT_THAT(felt(world).bodies, ElementsAre(beam.value, beam.value));
}

TEST(Bumper, FeelsNoBodyOnceItIsGone) {
  BumperScene scene;
  const BodyId o = scene.body("o", scene.robot("other", {box(0.2, 0.2)}), {0.315, 0, 0, 0});
  World world = scene.world();
  EXPECT_THAT(felt(world).bodies, ElementsAre(o.value, 0u));
  world.set_poses(std::vector<World::Placed>{{world.view().row(o), {0.4, 0, 0, 0}}});
  const Felt now = felt(world);
  EXPECT_THAT(now.hits, ElementsAre(0, 0));
  EXPECT_THAT(now.bodies, ElementsAre(0u, 0u));
}

}  // namespace
}  // namespace troupe::sensors::bumper_test
