#include "models/devices/actuator.hpp"

#include "engine/world/world.hpp"
#include "tests/support/devices.hpp"
#include "tests/support/message_of.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

namespace troupe::models::actuator_test {
namespace {

using engine::World;
using test::box;
using test::order;
using test::SceneBuilder;

constexpr double k_near = 1e-9;  // m: rounding

void step(World& world, std::size_t ticks) {
  for (std::size_t t = 0; t < ticks; ++t) world.step();
}

const ActuatorState& state(const World& world, BodyId body) {
  return test::state_of<ActuatorState>(world, body, 0);
}

/// A post with a slide in front of it, 0.2 m long from x = 0.2 on.
TypeId slide(SceneBuilder& scene, std::vector<engine::Record> orders,
             std::initializer_list<std::pair<std::string_view, engine::Value>> values) {
  const TypeId type = scene.type("post", {box(0.2, 0.2, 0.5)});
  test::add_arm(scene[type], "slide", {0.3, 0, 0, 0}, {box(0.2, 0.1, 0.2)}, values);
  if (!orders.empty()) scene[type].controllers.push_back(test::operate(std::move(orders)));
  return type;
}

TEST(Actuator, GoesToAPositionAtItsSpeedAndStops) {
  SceneBuilder scene;
  const BodyId body =
      scene.body("p", slide(scene, {order(0.1, "slide", "go_to", 0.75)}, {{"max_speed", 0.5}}));
  World world = scene.world();
  step(world, 2);
  EXPECT_NEAR(state(world, body).position, 0.05, k_near);
  EXPECT_NEAR(state(world, body).velocity, 0.5, k_near);
  step(world, 20);
  EXPECT_NEAR(state(world, body).position, 0.75, k_near);
  EXPECT_EQ(state(world, body).velocity, 0);
  EXPECT_EQ(state(world, body).stalled, 0);
  EXPECT_NEAR(world.view().outline(world.view().row(body)).last(4).front().x(), 0.2 + 0.75, k_near);
}

TEST(Actuator, TurnsAtTheOriginOfABodyThatIsNoObstacle) {
  SceneBuilder scene;
  const TypeId type = scene.type("base", {box(0.4, 0.4, 0.2)}, {.obstacle = false});
  test::add_arm(scene[type], "turret", {}, {box(0.4, 0.1, 0.1)},
                {{"type", "rotational"}, {"max_position", 3.0}, {"max_speed", 0.3}});
  for (engine::PartSpec& part : scene[type].parts) part.returns.obstacle = false;
  scene[type].controllers.push_back(test::operate({order(0.1, "turret", "go_to", 1)}));
  const BodyId body = scene.body("b", type);
  World world = scene.world();
  step(world, 11);
  EXPECT_NEAR(state(world, body).position, 0.3, 0.05);
  step(world, 40);
  EXPECT_NEAR(state(world, body).position, 1, k_near);
}

TEST(Actuator, ASpeedEndsAtTheLimits) {
  SceneBuilder scene;
  const BodyId body = scene.body("p", slide(scene, {order(0.1, "slide", "speed", -3)},
                                            {{"min_position", -0.25}, {"start_position", 0.5}}));
  World world = scene.world();
  EXPECT_EQ(state(world, body).position, 0.5);
  EXPECT_NEAR(world.view().outline(world.view().row(body)).last(4).front().x(), 0.7, k_near)
      << "as it starts";
  step(world, 20);
  EXPECT_EQ(state(world, body).position, -0.25);
}

TEST(Actuator, CommandsOfAnySizeAreClampedAndNaNIsAnError) {
  constexpr double k_infinity = std::numeric_limits<double>::infinity();
  SceneBuilder scene;
  const BodyId body = scene.body("p", slide(scene, {}, {{"min_position", -0.25}, {"max_speed", 0.5}}));
  World world = scene.world();
  const auto command = [&](std::uint8_t mode, double goal) {
    const Row row = world.view().row(body);
    *reinterpret_cast<ActuatorCommand*>(world.device_command(row, world.view().type(row).devices[0])) = {
        mode, goal};
  };
  for (const std::uint8_t mode : {ActuatorCommand::velocity, ActuatorCommand::position})
    for (const double goal : {k_infinity, -1e300, 1e300, -k_infinity}) {
      command(mode, goal);
      const double before = state(world, body).position;
      step(world, 1);
      EXPECT_NEAR(std::abs(state(world, body).position - before), 0.05, k_near) << int{mode} << ' ' << goal;
      step(world, 30);
      EXPECT_EQ(state(world, body).position, goal > 0 ? 1 : -0.25) << int{mode} << ' ' << goal;
    }
  command(ActuatorCommand::position, std::nan(""));
  EXPECT_EQ(test::message_of<engine::StepError>([&] { world.step(); }),
            "tick 249: an actuator of \"p\" was commanded a position that is not a number");
}

TEST(Actuator, StopsAtWhatIsInItsWay) {
  SceneBuilder scene;
  const BodyId body = scene.body("p", slide(scene, {order(0.1, "slide", "speed", 1)}, {}));
  scene.wall(0.72, -1, 0.73, 1);
  World world = scene.world();
  step(world, 20);
  EXPECT_NEAR(state(world, body).position, 0.3, k_near) << "the next step would reach 0.8 m";
  EXPECT_EQ(state(world, body).stalled, 1);
}

/// The tip of the slide is 1 cm in a wall at the start: it can go back, but not through the wall.
TEST(Actuator, LeavesWhatItOverlapsButGoesNoDeeper) {
  for (const bool is_static : {true, false}) {
    SceneBuilder scene;
    const BodyId body =
        scene.body("p", slide(scene, {order(0.1, "slide", "speed", 1), order(0.6, "slide", "speed", -0.1)},
                              {{"min_position", -0.1}}));
    if (is_static)
      scene.wall(0.39, -1, 0.6, 1);
    else
      scene.body("crate", scene.robot("crate", {box(0.2, 2)}), {0.49, 0, 0, 0});
    World world = scene.world();
    step(world, 4);
    EXPECT_EQ(state(world, body).position, 0) << is_static;
    EXPECT_EQ(state(world, body).stalled, 1) << is_static;
    step(world, 3);
    EXPECT_LT(state(world, body).position, -0.005) << is_static;
    EXPECT_EQ(state(world, body).stalled, 0) << is_static;
  }
}

TEST(Actuator, ThinWallsAreNotPassed) {
  SceneBuilder scene;
  const BodyId body = scene.body(
      "p", slide(scene, {order(0.1, "slide", "speed", 100)}, {{"max_speed", 100.0}, {"max_position", 50.0}}));
  scene.wall(3, -1, 3.01, 1);
  World world = scene.world();
  step(world, 20);
  EXPECT_EQ(state(world, body).position, 0) << "10 m a tick would pass it";
  EXPECT_EQ(state(world, body).stalled, 1);
}

/// A shelf from 0.55 to 0.59 m above the floor, wider or narrower than the plate of the lift: a wider one
/// meets the plate with none of its edges. A fast lift would pass the shelf within one tick.
TEST(Actuator, ALiftStopsBelowAShelf) {
  for (const bool is_static : {true, false})
    for (const double width : {0.2, 0.58})
      for (const double speed : {0.1, 1.0}) {
        SceneBuilder scene;
        const TypeId post = scene.type("post", {box(0.4, 0.4, 2)});
        test::add_arm(scene[post], "lift", {0.5, 0, 0, 0}, {box(0.4, 0.4, 0.02)},
                      {{"axis", std::vector<double>{0, 0, 1}}, {"max_position", 2.0}, {"max_speed", speed}});
        scene[post].controllers.push_back(test::operate({order(0, "lift", "go_to", 1.5)}));
        const BodyId body = scene.body("p", post);
        const Solid board{{test::box_ring(0.58, width)}, {0.55, 0.59}};
        const TypeId shelf = is_static ? scene.type("shelf", {board}) : scene.robot("shelf", {board});
        scene.body("s", shelf, {0.5, 0, 0, 0});
        World world = scene.world();
        step(world, 70);
        EXPECT_GT(state(world, body).position, 0.45) << is_static << ' ' << width << ' ' << speed;
        EXPECT_LE(state(world, body).position, 0.53 + k_near) << is_static << ' ' << width << ' ' << speed;
        EXPECT_EQ(state(world, body).stalled, 1) << is_static << ' ' << width << ' ' << speed;
      }
}

TEST(Actuator, ReachesAGoalExactlyAndIsNotStalledThere) {
  for (const double goal : {0.055, 0.1, 0.21, 0.37, 0.81}) {
    SceneBuilder scene;
    const BodyId body = scene.body(
        "p", slide(scene, {order(0, "slide", "go_to", goal)}, {{"axis", std::vector<double>{1, 1, 0}}}));
    World world = scene.world();
    for (int t = 0; t < 60; ++t) {
      world.step();
      ASSERT_EQ(state(world, body).stalled, 0) << "goal " << goal << ", tick " << world.tick();
    }
    EXPECT_EQ(state(world, body).position, goal);
    EXPECT_EQ(state(world, body).velocity, 0);
  }
}

TEST(Actuator, GoesBackAtItsSpeedWhenItsLimitsChange) {
  SceneBuilder scene;
  const BodyId body = scene.body("p", slide(scene, {},
                                            {{"axis", std::vector<double>{0, 0, 1}},
                                             {"max_position", 1.0},
                                             {"start_position", 1.0},
                                             {"max_speed", 0.5}}));
  const engine::FieldTable& table = test::registry().device("actuator")->params;
  engine::Record params(table.fields.size());
  get(table, params, "max_position") = 0.83;
  engine::InterventionSpec set{.time_s = 0.3,
                               .action = engine::InterventionSpec::Action::set,
                               .whom = {},
                               .pose = {},
                               .region = {},
                               .setting = engine::SettingSpec{scene.spec.bodies[body.index()].type,
                                                              engine::SettingSpec::Of::device, 0, params}};
  scene.spec.experiment.at = {set};
  World world = scene.world();
  double before = 1;
  for (int t = 0; t < 12; ++t) {
    world.step();
    EXPECT_LE(before - state(world, body).position, 0.05 + k_near) << "tick " << world.tick();
    before = state(world, body).position;
  }
  EXPECT_EQ(state(world, body).position, 0.83);
  EXPECT_EQ(state(world, body).stalled, 0);
}

/// A turntable: what stands on it turns about the actuator's origin, sensors too.
TEST(Actuator, TurnsWhatStandsOnIt) {
  SceneBuilder scene;
  const TypeId type = scene.type("mast", {box(0.2, 0.2, 0.5)});
  test::add_arm(scene[type], "pan", {0, 0, 0.5, 0}, {box(0.1, 0.1, 0.1)},
                {{"type", "rotational"}, {"max_position", 10.0}, {"max_speed", 10.0}});
  scene[type].controllers.push_back(test::operate({order(0.1, "pan", "go_to", k_pi / 2)}));
  engine::DeviceSpec eye = test::ranger("eye", {{.pose = {0.1, 0, 0.05, 0}}});
  eye.joint = scene[type].devices[0].moves;
  eye.pose_body_device = {0, 0, 0.5, 0};
  scene[type].devices.push_back(eye);
  const BodyId body = scene.body("m", type, {1, 0, 0, 0});
  scene.wall(3, -2, 3.1, 2);
  scene.wall(0.5, 1, 1.5, 1.1);
  for (const auto ranging : {engine::RangingEngine::exact, engine::RangingEngine::grid}) {
    scene.spec.ranging = ranging;
    World world = scene.world();
    const auto range = [&] {
      const Row row = world.view().row(body);
      return world.tables()[world.view().type(row).devices[1].table].cell<float>(world.view().slot(row),
                                                                                 0)[0];
    };
    step(world, 1);
    EXPECT_NEAR(range(), 1.9, 0.03);
    step(world, 5);
    EXPECT_NEAR(state(world, body).position, k_pi / 2, k_near);
    EXPECT_NEAR(range(), 0.9, 0.03) << "it looks along y now";
  }
}

/// A lift raises what stands on it: rays below it pass.
TEST(Actuator, RaisesWhatStandsOnIt) {
  SceneBuilder scene;
  const TypeId gate = scene.type("gate", {box(0.1, 0.1, 0.1)});
  scene[gate].parts[0].solids.clear();
  test::add_arm(scene[gate], "lift", {0, 0, 0, 0}, {box(0.1, 1, 0.5)},
                {{"axis", std::vector<double>{0, 0, 2}}, {"max_position", 0.6}});
  scene[gate].controllers.push_back(test::operate({order(0.5, "lift", "go_to", 0.6)}));
  const TypeId mover = scene.robot("mover", {box(0.2, 0.2, 0.4)});
  scene[mover].devices.push_back(test::ranger("eye", {{.pose = {0, 0, 0.2, 0}}}));
  scene[mover].controllers.push_back(test::drive_legs({test::leg(20, 0.5)}));
  scene.body("g", gate, {1, 0, 0, 0});
  const BodyId robot = scene.body("r", mover);
  World world = scene.world();
  step(world, 1);
  EXPECT_NEAR(
      world.tables()[world.view().type(world.view().row(robot)).devices[0].table].cell<float>(0, 0)[0], 0.95,
      1e-4);
  step(world, 39);
  EXPECT_GT(world.view().pose(robot).x, 1.5) << "the gate opened in time";
  World closed = [&] {
    scene[gate].controllers.clear();
    return scene.world();
  }();
  step(closed, 40);
  EXPECT_LT(closed.view().pose(robot).x, 0.86);
  EXPECT_TRUE(closed.view().stalled(closed.view().row(robot)));
}

TEST(Actuator, OneOnAnotherMovesWithIt) {
  SceneBuilder scene;
  const TypeId type = slide(scene, {}, {});
  const std::size_t second = test::add_arm(scene[type], "second", {0.5, 0, 0, 0}, {box(0.2, 0.1, 0.2)}, {});
  engine::TypeSpec& spec = scene[type];
  spec.devices[second].joint = spec.devices[0].moves;
  spec.joints[static_cast<std::size_t>(spec.devices[second].moves)].parent = spec.devices[0].moves;
  spec.controllers.push_back(
      test::operate({order(0.1, "slide", "go_to", 0.2), order(0.1, "second", "go_to", 0.3)}));
  const BodyId body = scene.body("p", type);
  World world = scene.world();
  step(world, 10);
  EXPECT_NEAR(world.view().outline(world.view().row(body)).last(4).front().x(), 0.4 + 0.2 + 0.3, k_near);
}

}  // namespace
}  // namespace troupe::models::actuator_test
