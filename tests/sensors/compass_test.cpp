#include "sensors/compass.hpp"

#include "engine/world/world.hpp"
#include "tests/support/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace troupe::sensors::compass_test {
namespace {

using engine::World;
using test::box;
using test::SceneBuilder;

// Of its own, so that nothing is shared with what is tested.
constexpr double k_half_turn = std::numbers::pi;

/// Robots at these headings, each with a compass that is turned by `mounted`.
struct CompassScene : SceneBuilder {
  CompassScene(const std::vector<double>& headings, double mounted, double noise_stddev, double declination) {
    const TypeId type = robot("robot", {box(0.2, 0.2)});
    (*this)[type].devices = {{.name = "compass",
                              .kind = "compass",
                              .params = {noise_stddev, declination},
                              .pose_body_device = {0.05, 0, 0.1, mounted},
                              .active = true,
                              .where = {}}};
    for (std::size_t i = 0; i < headings.size(); ++i)
      body("r" + std::to_string(i), type, {static_cast<double>(i), 0, 0, headings[i]});
  }
};

/// The readings after a tick, by robot.
std::vector<double> readings(World& world, std::size_t robots) {
  world.step();
  std::vector<double> all;
  for (std::size_t i = 0; i < robots; ++i) {
    const Row row = world.view().row(BodyId(1 + i));  // body 0 is the ground
    const engine::StateTable& table = world.tables()[world.view().type(row).devices[0].table];
    all.push_back(table.cell<double>(world.view().slot(row), k_compass_heading)[0]);
  }
  return all;
}
std::vector<double> readings(const CompassScene& scene, std::size_t robots) {
  World world = scene.world();
  return readings(world, robots);
}

TEST(Compass, WithoutNoiseReadsTheHeadingExactly) {
  const std::vector<double> headings{0, 0.25, -0.25, 1.5, -3, 3};
  EXPECT_EQ(readings(CompassScene(headings, 0, 0, 0), headings.size()), headings);
}

TEST(Compass, ReadsItsOwnHeadingAndTheDeclination) {
  const std::vector<double> got = readings(CompassScene({0.5, -2}, 0.25, 0, 0.125), 2);
  EXPECT_DOUBLE_EQ(got[0], 0.875);
  EXPECT_DOUBLE_EQ(got[1], -1.625);
}

TEST(Compass, ReadsWithinHalfATurnToEitherSide) {
  // Beyond half a turn: 3 + 1 is 4 - 2 pi; at half a turn it is the positive one, whichever way it was
  // turned.
  const std::vector<double> got = readings(CompassScene({3, -3, k_half_turn, -k_half_turn}, 0, 0, 0), 4);
  EXPECT_EQ(got, (std::vector<double>{3, -3, k_half_turn, k_half_turn}));
  const std::vector<double> turned = readings(CompassScene({3, -3}, 1, 0, 0), 2);
  EXPECT_NEAR(turned[0], 4 - 2 * k_half_turn, 1e-12);
  EXPECT_NEAR(turned[1], -2, 1e-12);
}

TEST(Compass, FollowsARobotThatTurns) {
  const CompassScene scene({1}, 0.5, 0, 0);
  World world = scene.world();
  world.set_command(world.view().row(BodyId(1)), {.turn = 0.5});
  // A reading is of the pose before the tick's motion: 0.05 rad a tick of 0.1 s.
  for (int tick = 0; tick < 60; ++tick) {
    const double expected = 1.5 + 0.05 * tick;
    const double read = readings(world, 1)[0];
    EXPECT_NEAR(std::remainder(read - expected, 2 * k_half_turn), 0, 1e-9) << tick;
    EXPECT_LE(read, k_half_turn);
    EXPECT_GT(read, -k_half_turn);
  }
}

TEST(Compass, NoiseIsNormalAndIndependentOfBodiesAndTicks) {
  constexpr double k_stddev = 0.1;
  constexpr std::size_t k_robots = 40;
  constexpr int k_ticks = 100;
  const CompassScene scene(std::vector<double>(k_robots, 2.0), 0, k_stddev, -0.5);
  World world = scene.world();
  double sum = 0, squares = 0, of_neighbours = 0, of_ticks = 0, beyond_one = 0;
  std::vector<double> before(k_robots, 0);
  for (int tick = 0; tick < k_ticks; ++tick) {
    const std::vector<double> got = readings(world, k_robots);
    for (std::size_t i = 0; i < k_robots; ++i) {
      const double error = got[i] - 1.5;
      sum += error;
      squares += error * error;
      beyond_one += std::abs(error) > k_stddev ? 1 : 0;
      of_neighbours += error * (got[(i + 1) % k_robots] - 1.5);
      of_ticks += error * before[i];
      before[i] = error;
    }
  }
  // Each within four standard errors; of a normal variable 31.73 % lie farther than one deviation from the
  // mean.
  const double n = k_robots * k_ticks;
  EXPECT_NEAR(sum / n, 0, 4 * k_stddev / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), k_stddev, 4 * k_stddev / std::sqrt(2 * n));
  EXPECT_NEAR(beyond_one / n, 0.3173, 4 * std::sqrt(0.3173 * 0.6827 / n));
  EXPECT_NEAR(of_neighbours / n, 0, 4 * k_stddev * k_stddev / std::sqrt(n));
  EXPECT_NEAR(of_ticks / n, 0, 4 * k_stddev * k_stddev / std::sqrt(n));
}

}  // namespace
}  // namespace troupe::sensors::compass_test
