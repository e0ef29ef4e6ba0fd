#include "sensors/ranger_grid.hpp"

#include "tests/support/message_of.hpp"
#include "tests/support/scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace troupe::sensors::ranger_grid_test {
namespace {

using engine::World;
using test::SceneBuilder;
using test::Transducer;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::FloatNear;

constexpr float k_cell = 0.0201f;  // the error of a reading along an axis

std::span<const float> readings(const World& world, BodyId body, std::size_t sensor = 0,
                                std::size_t field = 0) {
  const Row row = world.view().row(body);
  return world.tables()[world.view().type(row).devices[sensor].table].cell<float>(world.view().slot(row),
                                                                                  field);
}

/// A robot of 0.4 m with a ring of four beams and a second robot's place, by the grid engine.
struct Yard : SceneBuilder {
  explicit Yard(bool intensity = false) {
    spec.ranging = engine::RangingEngine::grid;
    bot = robot("bot", {Solid{{test::box_ring(0.4, 0.4)}, {0, 0.5}}});
    (*this)[bot].devices = {test::ranger("eyes",
                                         {{.pose = {0, 0, 0.3, 0}},
                                          {.pose = {0, 0, 0.3, k_pi / 2}},
                                          {.pose = {0, 0, 0.3, k_pi}, .range_max = 3},
                                          {.pose = {0, 0, 0.7, -k_pi / 2}}},
                                         intensity)};
  }
  TypeId bot;
};

TEST(RangerGrid, SeesWallsAndOthersButNotItself) {
  Yard yard(true);
  const BodyId me = yard.body("me", yard.bot, {0.01, 0.01, 0, 0});
  yard.body("other", yard.bot, {0.01, 2.01, 0, 0});
  yard.wall(1.31, -5, 1.51, 5, {.ranger = 0.5f});
  yard.wall(-5, -2, 5, -1.29, {.ranger = 0});
  World world = yard.world();
  world.step();
  EXPECT_THAT(readings(world, me),
              ElementsAre(FloatNear(1.3f, k_cell), FloatNear(1.8f, k_cell), 3.0f, FloatNear(1.3f, k_cell)));
  EXPECT_THAT(readings(world, me, 0, 1), ElementsAre(0.5f, 1.0f, 0.0f, 0.0f));
}

TEST(RangerGrid, TransparentAndLowThingsAreMissed) {
  Yard yard;
  const BodyId me = yard.body("me", yard.bot);
  yard.wall(1, -5, 2, 5, {.ranger = -1});
  yard.body("low", yard.type("low", {Solid{{test::box_ring(0.2, 0.2)}, {0, 0.29}}}), {0, 2, 0, 0});
  yard.body("high", yard.type("high", {Solid{{test::box_ring(0.2, 0.2)}, {0.31, 0.5}}}), {-2, 0, 0, 0});
  World world = yard.world();
  world.step();
  EXPECT_THAT(readings(world, me), ElementsAre(5, 5, 3, 5));
}

TEST(RangerGrid, ReadsTheStateBeforeTheTick) {
  Yard yard;
  const BodyId me = yard.body("me", yard.bot);
  const BodyId other = yard.body("other", yard.bot, {2, 0, 0, 0});
  World world = yard.world();
  world.set_command(world.view().row(other), {1, 0, 0});
  for (int tick = 1; tick <= 20; ++tick) {
    const double face = world.view().pose(other).x - 0.2;
    world.step();
    EXPECT_NEAR(readings(world, me)[0], face, 0.03) << "tick " << tick;
  }
  EXPECT_GT(world.view().pose(other).x, 3.5);
}

TEST(RangerGrid, CellsAreAsLargeAsTheWorldSays) {
  Yard yard;
  yard.spec.resolution_m = 0.5;
  const BodyId me = yard.body("me", yard.bot, {0.3, 0.2, 0, 0});
  yard.wall(2.6, -5, 3, 5);
  World world = yard.world();
  world.step();
  EXPECT_EQ(readings(world, me)[0], 5 * 0.5f);  // from [0, 0.5) to [2.5, 3)
}

TEST(RangerGrid, AnOutlineThatTheWorldCannotHoldIsSaidAtTheResolution) {
  Yard yard;
  yard.spec.resolution_m = 1e-4;
  yard.body("me", yard.bot);
  yard.wall(-4e4, -4e4, 4e4, 4e4);
  Diagnostics diagnostics;
  yard.spec.resolution_where = {diagnostics.files()->add("yard.json"), 7};
  EXPECT_THAT(
      test::message_of<InputError>([&] { const World world(yard.spec, test::registry(), {}, diagnostics); }),
      ::testing::StartsWith("yard.json:7: error: the grid ray engine: cells of 0.0001 m would take "));
}

TEST(RangerGrid, TheExactEngineHasNoGrid) {
  Yard yard;
  yard.body("me", yard.bot);
  EXPECT_NE(yard.world().view().ray_grid(), nullptr);
  yard.spec.ranging = engine::RangingEngine::exact;
  EXPECT_EQ(yard.world().view().ray_grid(), nullptr);
}

}  // namespace
}  // namespace troupe::sensors::ranger_grid_test
