#include "engine/world/world.hpp"

#include "engine/kinds/controller.hpp"
#include "engine/spec/ticks.hpp"
#include "tests/support/devices.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scene.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cfenv>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace troupe::engine::world_test {
namespace {

using test::box;
using test::Moody;
using test::SceneBuilder;

TEST(World, ACommandOfAControllerActsATickAfterItsReadings) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  scene[type].controllers = {test::controller("script", {{"law", "line"}})};
  const BodyId body = scene.body("r", type);
  World world = scene.world();
  world.step();
  EXPECT_EQ(world.view().pose(body).x, 0) << "decided in this tick, driven in the next";
  world.step();
  EXPECT_DOUBLE_EQ(world.view().pose(body).x, 0.05);
}

TEST(World, ARestartThatTheGridRefusesChangesNothing) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  scene[type].devices = {test::ranger("eye", {{.range_max = 5}})};
  scene[type].devices[0].pose_body_device.z = 0.5;
  scene[type].controllers = {test::controller("script", {{"law", "line"}})};
  const BodyId robot = scene.body("r", type);
  const BodyId wall = scene.body("w", scene.type("wall", {box(0.2, 2)}), {2, 0, 0, 0});
  scene.spec.ranging = RangingEngine::grid;
  World world = scene.world();
  const std::uint64_t start = world.hashes().state;
  const auto range_after_a_step = [&] {
    world.step();
    const Row row = world.view().row(robot);
    return world.tables()[world.view().type(row).devices[0].table].cell<float>(world.view().slot(row), 0)[0];
  };
  const float range = range_after_a_step();
  EXPECT_NEAR(range, 1.9, 0.03);

  std::vector<BodySpec> bodies = world.spec().bodies;
  bodies[wall.index()].pose_world_body.x = 2e7;
  EXPECT_THROW(world.restart(7, bodies, test::registry()), InputError);
  EXPECT_EQ(world.tick(), 0u);
  EXPECT_EQ(world.hashes().state, start);
  EXPECT_EQ(world.spec().seed, scene.spec.seed);
  EXPECT_EQ(world.spec().bodies[wall.index()].pose_world_body.x, 2);
  EXPECT_EQ(range_after_a_step(), range);

  bodies[wall.index()].pose_world_body.x = 3;
  world.restart(7, bodies, test::registry());
  EXPECT_EQ(world.spec().seed, 7u);
  EXPECT_NEAR(range_after_a_step(), 2.9, 0.03);
}

TEST(World, ARestartMayTurnAWallWhereItStands) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  scene[type].devices = {test::ranger("eye", {{.range_max = 5}})};
  const BodyId robot = scene.body("r", type);
  const BodyId wall = scene.body("w", scene.type("wall", {box(0.5, 2)}), {3, 0, 0, 0});
  World world = scene.world();
  std::vector<BodySpec> bodies = world.spec().bodies;
  bodies[wall.index()].pose_world_body.heading = k_pi / 2;
  world.restart(7, bodies, test::registry());
  world.step();
  const Row row = world.view().row(robot);
  EXPECT_FLOAT_EQ(
      world.tables()[world.view().type(row).devices[0].table].cell<float>(world.view().slot(row), 0)[0], 2);
}

TEST(World, AfterARestartThatThrewTheGridHasTheNewScene) {
  Registry registry = test::registry();
  registry.devices.push_back(Moody::kind());
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  scene[type].devices = {test::ranger("eye", {{.range_max = 5}}),
                         {.name = "moody", .kind = "moody", .params = {}, .where = {}}};
  scene[type].devices[0].pose_body_device.z = 0.5;
  const BodyId robot = scene.body("r", type);
  const BodyId wall = scene.body("w", scene.type("wall", {box(0.2, 2)}), {2, 0, 0, 0});
  scene.spec.ranging = RangingEngine::grid;
  Diagnostics diagnostics;
  World world(scene.spec, registry, {.threads = 1}, diagnostics);
  std::vector<BodySpec> bodies = world.spec().bodies;
  bodies[wall.index()].pose_world_body.x = 3;
  Moody::throws = true;
  EXPECT_THROW(world.restart(7, bodies, registry), StepError);
  Moody::throws = false;
  world.reset();
  world.step();
  const Row row = world.view().row(robot);
  EXPECT_NEAR(
      world.tables()[world.view().type(row).devices[0].table].cell<float>(world.view().slot(row), 0)[0], 2.9,
      0.03);
}

TEST(World, ARestartThatAKindRefusesChangesNothing) {
  static int calls;
  calls = 0;
  Registry registry = test::registry();
  DeviceKind picky{.name = "picky", .text = ""};
  picky.prepare = [](const Record&, const Pose&) { return DeviceKind::Prepared{.data = 0}; };
  picky.bind_world = [](std::any&, const WorldSpec&) -> Result<> {
    if (++calls == 2) return Error{"does not like these poses"};  // the first call is for the constructor
    return {};
  };
  picky.sense = [](const SenseBatch&) -> std::uint64_t { return 0; };
  registry.devices.push_back(picky);
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  scene[type].devices = {{.name = "picky", .kind = "picky", .params = {}, .active = true, .where = {}}};
  const BodyId robot = scene.body("r", type);
  Diagnostics diagnostics;
  World world(scene.spec, registry, {.threads = 1}, diagnostics);
  const std::uint64_t start = world.hashes().state;
  world.set_command(world.view().row(robot), {1, 0, 0});
  world.step();

  std::vector<BodySpec> bodies = world.spec().bodies;
  bodies[robot.index()].pose_world_body.x = 3;
  EXPECT_THROW(world.restart(7, bodies, registry), std::logic_error);
  EXPECT_EQ(world.tick(), 0u);
  EXPECT_EQ(world.hashes().state, start);
  EXPECT_EQ(world.spec().seed, scene.spec.seed);
  EXPECT_EQ(world.view().pose(robot).x, 0);
  world.restart(7, bodies, registry);
  EXPECT_EQ(world.spec().seed, 7u);
  EXPECT_EQ(world.view().pose(robot).x, 3);
}

TEST(World, TransformsAreThoseOfThePoses) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  const BodyId body = scene.body("r", type, {3, -2, 0, 0.7});
  World world = scene.world();
  const Row row = world.view().row(body);
  world.set_command(row, {0.5, 0, 0.9});
  for (int tick = 0; tick < 4; ++tick) {
    const Transform expected(world.view().pose(body));
    EXPECT_EQ(world.view().transform(row).position, expected.position);
    EXPECT_EQ(world.view().transform(row).rotation.cos, expected.rotation.cos);
    EXPECT_EQ(world.view().transform(row).rotation.sin, expected.rotation.sin);
    world.step();
  }
  EXPECT_NE(world.view().pose(body).heading, 0.7);
}

TEST(World, PeriodsRoundUpToTicks) {
  EXPECT_EQ(period_ticks(0, 0.1), 1u);
  EXPECT_EQ(period_ticks(0.01, 0.1), 1u);
  EXPECT_EQ(period_ticks(0.1, 0.1), 1u);
  EXPECT_EQ(period_ticks(0.25, 0.1), 3u);
  EXPECT_EQ(period_ticks(0.3, 0.1), 3u);
  EXPECT_EQ(period_ticks(0.1, 0.02), 5u);
  EXPECT_EQ(period_ticks(1e300, 0.1), 1000000000000000u);
}

TEST(World, TimesRoundUpToTicksWhateverTheirQuotientRoundsTo) {
  EXPECT_EQ(ticks_until(0.7, 0.1), 7u);
  EXPECT_EQ(ticks_until(0.9, 0.3), 3u);
  EXPECT_EQ(ticks_until(0.71, 0.1), 8u);
  EXPECT_EQ(ticks_until(0, 0.1), 0u);
  EXPECT_EQ(ticks_until(-1, 0.1), 0u);
  EXPECT_EQ(ticks_until(1e-10, 0.1), 0u);  // one billionth of a tick
  EXPECT_EQ(ticks_until(2e-10, 0.1), 1u);
  EXPECT_EQ(ticks_until(60, 0.1), 600u);
  EXPECT_EQ(ticks_until(1e8, 0.1), 1000000000u);
  EXPECT_EQ(ticks_until(1e12, 0.1), 10000000000000u);
  EXPECT_EQ(ticks_until(123456789.3, 0.01), 12345678930u);
  EXPECT_EQ(ticks_until(1e300, 1e-300), 1000000000000000u);
}

TEST(World, WholeTicksInADurationAreRoundedDown) {
  EXPECT_EQ(ticks_within(0.3, 0.1), 3u) << "0.3 / 0.1 is slightly below 3 in floating point";
  EXPECT_EQ(ticks_within(0.29, 0.1), 2u);
  EXPECT_EQ(ticks_within(0, 0.1), 0u);
  EXPECT_EQ(ticks_within(-1, 0.1), 0u);
  EXPECT_EQ(ticks_within(std::numeric_limits<double>::quiet_NaN(), 0.1), 0u);
  EXPECT_EQ(ticks_within(1e300, 0.1), k_most_ticks);
}

TEST(World, SubscribingToOneRobotRunsItsSensorsAlone) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  scene[type].devices = {test::ranger("ir", {{.range_max = 3}})};
  scene[type].devices[0].active = false;
  const BodyId a = scene.body("a", type);
  const BodyId b = scene.body("b", type, {5, 0, 0, 0});
  World world = scene.world();
  world.subscribe(b);
  world.step();
  EXPECT_EQ(world.counters().beams, 1u);
  const BodyType::Device& sensor = world.view().type(world.view().row(a)).devices[0];
  EXPECT_FALSE(world.view().senses(world.view().row(a), sensor));
  EXPECT_TRUE(world.view().senses(world.view().row(b), sensor));
  EXPECT_EQ(world.tables()[sensor.table].cell<float>(world.view().slot(world.view().row(a)), 0)[0], 0);
  EXPECT_EQ(world.tables()[sensor.table].cell<float>(world.view().slot(world.view().row(b)), 0)[0], 3);
}

TEST(World, BoundsTheWrongWayRoundAreAnError) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  scene[type].drive = test::drive("diff", {{"velocity_min_x", 1.0}, {"velocity_max_x", -1.0}});
  scene.body("r", type);
  Diagnostics diagnostics;
  EXPECT_THROW(World(scene.spec, test::registry(), {.threads = 1}, diagnostics), InputError);
  EXPECT_EQ(diagnostics.text(diagnostics.findings()[0]),
            "error: drive \"diff\": velocity_min_x, velocity_max_x: lower bound 1 exceeds upper bound -1");
}

// Programs may give the constructor a spec that no loader has made.
TEST(World, ASpecThatBreaksARuleIsAnError) {
  const auto error_after = [](auto&& damage) {
    SceneBuilder scene;
    scene.body("r0", scene.robot("robot", {box(0.4, 0.4)}));
    damage(scene.spec);
    return scene.error();
  };
  EXPECT_EQ(error_after([](WorldSpec&) {}), "");
  EXPECT_THAT(error_after([](WorldSpec& spec) { spec.bodies[1].type = TypeId(9); }),
              testing::HasSubstr("bodies[1].type: the world has 2 types, found index 9 (counted from 0)"));
  EXPECT_THAT(error_after([](WorldSpec& spec) { spec.types[1].parts.clear(); }),
              testing::HasSubstr("types[1].parts: empty"));
  EXPECT_THAT(error_after([](WorldSpec& spec) { spec.bodies.erase(spec.bodies.begin()); }),
              testing::HasSubstr("bodies[0]: must be the ground"));
  EXPECT_THAT(error_after([](WorldSpec& spec) { spec = {}; }), testing::HasSubstr("bodies: empty"));
}

// Such a row would be a place in memory beyond the tables.
TEST(World, FunctionsForProgramsRefuseRowsThatDoNotExist) {
  SceneBuilder scene;
  scene.spec.mortal = true;
  const TypeId robot = scene.robot("robot", {box(0.4, 0.4)});
  scene[robot].devices = {test::ranger("eye", {{.range_max = 5}})};
  scene.body("r0", robot);
  const BodyId wall = scene.wall(2, -1, 2.2, 1);
  World world = scene.world();
  const std::uint64_t before = world.hashes().state;
  using Call = std::function<void(Row)>;
  const std::vector<std::pair<std::string, Call>> calls{
      {"set_command()",
       [&](Row row) {
         world.set_command(row, {1, 0, 0});
       }},
      {"set_estimate()", [&](Row row) { world.set_estimate(row, {}); }},
      {"set_poses()",
       [&](Row row) {
         const World::Placed placed{row, {1, 0, 0, 0}};
         world.set_poses({&placed, 1});
       }},
      {"is_free()", [&](Row row) { static_cast<void>(world.is_free(row, {})); }},
      {"remove()", [&](Row row) { world.remove(row); }},
      {"disable()", [&](Row row) { world.set_disabled(row, true); }}};
  for (const auto& [name, call] : calls) {
    EXPECT_EQ(test::message_of<std::out_of_range>([&, &act = call] { act(world.view().row(wall)); }),
              name + ": found no row: static bodies, and bodies that do not exist, have none");
    EXPECT_EQ(test::message_of<std::out_of_range>([&, &act = call] { act(Row(std::size_t{1})); }),
              name + ": found row 1, but the world has 1 rows, counted from 0");
  }
  EXPECT_THROW(world.subscribe(wall), std::out_of_range);
  EXPECT_THROW(world.subscribe(BodyId(std::size_t{9})), std::out_of_range);
  EXPECT_EQ(test::message_of<std::logic_error>(
                [&] { world.device_command(Row(0), world.view().type(Row(0)).devices[0]); }),
            "device_command(): device \"eye\" (ranger) takes no commands");
  EXPECT_EQ(test::message_of<std::invalid_argument>([&] { world.restart(7, {}, test::registry()); }),
            "restart(): found 0 bodies, but the world has 3");
  EXPECT_EQ(test::message_of<std::out_of_range>([&] { world.spawn(0, {}); }),
            "spawn(): found reserve 0, but the world has 0 reserves, counted from 0");
  const Result<> set = world.set({TypeId(9), SettingSpec::Of::drive, 0, {}}, test::registry());
  ASSERT_FALSE(set);
  EXPECT_EQ(set.error().text,
            "refers to a type, or to a drive, device or controller of a type, that does not exist");
  EXPECT_EQ(world.hashes().state, before);
}

// A step within a step would apply the interventions of the tick twice; a callback that replaces itself would
// be destroyed while it runs.
TEST(World, TheCallbackBeforeATickMayNotStepNorReplaceItself) {
  SceneBuilder scene;
  scene.body("r", scene.robot("robot", {box(0.4, 0.4)}));
  World world = scene.world();
  const std::vector<std::pair<std::string, std::function<void()>>> calls{
      {"step()", [&] { world.step(); }}, {"before_tick()", [&] { world.before_tick({}); }}};
  for (const auto& [name, call] : calls) {
    bool is_first = true;
    world.before_tick([&, &act = call] {
      if (std::exchange(is_first, false)) act();
    });
    EXPECT_EQ(test::message_of<std::logic_error>([&] { world.step(); }),
              name + " is not allowed in a callback of before_tick(): call it outside the callback");
    world.reset();
  }
  world.before_tick({});
  world.on_phase([&](std::optional<Phase>) { world.before_tick({}); });
  EXPECT_THAT(test::message_of<std::logic_error>([&] { world.step(); }),
              testing::StartsWith("before_tick() is not allowed during a step"));
  world.on_phase(nullptr);
  world.reset();
  world.step();
  EXPECT_EQ(world.tick(), 1u);
}

TEST(World, TwoSensorsOfOneNameAreToldApart) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  scene[type].devices = {test::ranger("ir", {{.range_max = 3}}), test::ranger("ir", {{.range_max = 4}})};
  scene.body("r", type);
  Diagnostics diagnostics;
  const World world(scene.spec, test::registry(), {.threads = 1}, diagnostics);
  EXPECT_EQ(world.view().types()[type.index()].devices[1].name, "ir#2");
  EXPECT_THAT(diagnostics.warnings(),
              testing::ElementsAre(
                  "warning: the type already has a sensor or device \"ir\": this one is renamed \"ir#2\""));
}

TEST(World, AWaferThinRobotIsAWarning) {
  SceneBuilder scene;
  scene.body("r", scene.robot("wafer", {box(0.4, 1e-5)}));
  Diagnostics diagnostics;
  const World world(scene.spec, test::registry(), {.threads = 1}, diagnostics);
  EXPECT_THAT(
      diagnostics.warnings(),
      testing::ElementsAre("warning: a part of type \"wafer\" is only 1e-05 m thick: each motion is tested "
                           "in steps of a quarter of this thickness, which is slow; make the part at least "
                           "0.0005 m thick"));
}

TEST(World, ABodyBelowTheFloorIsAWarning) {
  SceneBuilder scene;
  scene.body("r", scene.robot("robot", {box(0.4, 0.4)}), {0, 0, -0.1, 0});
  Diagnostics diagnostics;
  const World world(scene.spec, test::registry(), {.threads = 1}, diagnostics);
  EXPECT_THAT(diagnostics.warnings(),
              testing::ElementsAre("warning: a body extends below the floor (z = 0), which is not an "
                                   "obstacle: raise the body, if this is not intended"));
}

struct Thrower {
  std::vector<std::size_t> choose(std::span<const DeviceInfo>, std::vector<bool>&) { return {}; }
  void operator()(const Percept& percept, Random&, Actions&) const {
    if (percept.body >= 40) throw std::range_error(std::to_string(percept.body));
  }
};

TEST(World, AnExceptionOfAControllerComesOutOfTheStep) {
  Registry registry = test::registry();
  registry.controllers.push_back(make_controller_kind<Thrower>("thrower", ""));
  for (const unsigned threads : {1u, 2u, 8u}) {
    SceneBuilder scene;
    const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
    scene[type].controllers = {{.kind = "thrower", .params = {}, .where = {}}};
    for (int i = 0; i < 500; ++i) scene.body(std::to_string(i), type, {i * 1.0, 0, 0, 0});
    Diagnostics diagnostics;
    World world(scene.spec, registry, {.threads = threads}, diagnostics);
    try {
      world.step();
      FAIL() << "no exception";
    } catch (const StepError& error) {
      EXPECT_THROW(std::rethrow_if_nested(error), std::range_error);
    }
  }
}

struct Idler {
  static constexpr bool needs_drive = false;
  std::vector<std::size_t> choose(std::span<const DeviceInfo>, std::vector<bool>&) { return {}; }
  void operator()(const Percept&, Random&, Actions&) const {}
};

TEST(World, ABodyThatHasOnlyAControllerIsAnObstacle) {
  Registry registry = test::registry();
  registry.controllers.push_back(make_controller_kind<Idler>("idler", ""));
  SceneBuilder scene;
  const TypeId post = scene.type("post", {box(0.4, 0.4)});
  scene[post].controllers = {{.kind = "idler", .params = {}, .where = {}}};
  scene.body("post", post, {1, 0, 0, 0});
  const BodyId robot = scene.body("r", scene.robot("robot", {box(0.4, 0.4)}));
  Diagnostics diagnostics;
  World world(scene.spec, registry, {.threads = 1}, diagnostics);
  world.set_command(world.view().row(robot), {0.5, 0, 0});
  for (int tick = 0; tick < 40; ++tick) world.step();
  EXPECT_LT(world.view().pose(robot).x, 0.61);
  EXPECT_GT(world.view().pose(robot).x, 0.5);
}

TEST(World, ARobotAtTheSpeedOfLightDelaysNoOther) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  scene[type].drive = test::drive("diff", {{"velocity_max_x", 3e8}});
  const BodyId a = scene.body("a", type);
  scene.body("b", type, {0, 5, 0, 0});
  World world = scene.world();
  world.set_command(world.view().row(a), {3e8, 0, 0});
  for (int i = 0; i < 100; ++i)
    world.step();  // out of the world in one tick: held, and no query reaches that far
  EXPECT_EQ(world.view().pose(a).x, 0);
  EXPECT_EQ(world.view().counts().out_of_bounds, 1u);
}

TEST(World, ARobotThatWouldLeaveIsHeldAndCounted) {
  SceneBuilder scene;
  const BodyId body = scene.body("r", scene.robot("robot", {box(0.4, 0.4)}), {0.95, 0, 0, 0});
  scene.spec.bounds = Box::around(Vec2::Zero(), 1);
  World world = scene.world();
  world.set_command(world.view().row(body), {1, 0, 0});
  world.step();
  EXPECT_EQ(world.view().pose(body).x, 0.95);
  EXPECT_TRUE(world.view().stalled(world.view().row(body)));
  EXPECT_EQ(world.view().counts().out_of_bounds, 1u);
  world.set_command(world.view().row(body), {-1, 0, 0});
  world.step();
  EXPECT_DOUBLE_EQ(world.view().pose(body).x, 0.85);
  EXPECT_EQ(world.view().counts().out_of_bounds, 0u);
}

TEST(World, ARobotWithoutAMotionIsNotStalled) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  const BodyId a = scene.body("a", type);
  scene.body("b", type, {0.405, 0, 0, 0});
  World world = scene.world();
  world.set_command(world.view().row(a), {0.5, 0, 0});
  world.step();
  EXPECT_TRUE(world.view().stalled(world.view().row(a)));
  EXPECT_EQ(world.view().counts().stalled, 1u);
  world.set_command(world.view().row(a), {});
  world.step();
  EXPECT_FALSE(world.view().stalled(world.view().row(a)));
}

TEST(World, BodiesAtDifferentHeightsPassEachOther) {
  SceneBuilder scene;
  const BodyId low = scene.body("low", scene.robot("low", {box(0.4, 0.4, 0.2)}));
  const TypeId bridge = scene.type("bridge", {Solid{{test::rectangle(0.3, -1, 0.5, 1)}, {0.2, 0.4}}});
  scene.body("bridge", bridge);
  World world = scene.world();
  world.set_command(world.view().row(low), {1, 0, 0});
  for (int i = 0; i < 10; ++i) world.step();
  EXPECT_NEAR(world.view().pose(low).x, 1, 1e-12) << "the bridge begins at the height where the robot ends";
}

TEST(World, OnlyObstaclesBlock) {
  SceneBuilder scene;
  const BodyId robot = scene.body("r", scene.robot("robot", {box(0.4, 0.4)}));
  scene.wall(0.5, -1, 0.6, 1, {.obstacle = false, .ranger = 1});
  World world = scene.world();
  world.set_command(world.view().row(robot), {1, 0, 0});
  for (int i = 0; i < 10; ++i) world.step();
  EXPECT_NEAR(world.view().pose(robot).x, 1, 1e-12);
}

TEST(World, OverlapsAtTheStartAreOneCountedWarning) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  scene.body("a", type);
  scene.body("b", type, {0.1, 0, 0, 0});
  scene.body("c", type, {0.2, 0, 0, 0});
  Diagnostics diagnostics;
  const World world(scene.spec, test::registry(), {.threads = 1}, diagnostics);
  EXPECT_THAT(
      diagnostics.warnings(),
      testing::ElementsAre("warning: 3 pairs of bodies overlap at the start, for example \"a\" and \"b\"; "
                           "bodies that overlap may move apart, but not deeper into each other"));
}

TEST(World, TheReportOfOverlapsDependsOnNoThreadsAndNoCells) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  for (int i = 0; i < 700; ++i) scene.body("free", type, {i * 0.5, 9, 0, 0});
  for (int i = 700; i > 0; --i)  // each overlaps the next two before it, and the first six a wall
    scene.body(fmt::format("r{}", i), type, {i * 0.15, 0, i % 2 == 0 ? -0.1 : 0.0, 0});
  scene.wall(0, -1, 1, 1);
  const std::string floor =
      "warning: a body extends below the floor (z = 0), which is not an obstacle: raise the body, if this is "
      "not intended (and 349 more such warnings)";
  const std::string pairs = fmt::format(
      "warning: {} pairs of bodies overlap at the start, for example \"r700\" and \"r699\"; bodies that "
      "overlap may move apart, but not deeper into each other",
      699 + 698 + 7);
  for (const unsigned threads : {1u, 2u, 3u, 8u})
    for (const double tile_m : {0.0, 1.0, 100.0}) {
      Diagnostics diagnostics;
      const World world(scene.spec, test::registry(), {.threads = threads, .tile_size_m = tile_m},
                        diagnostics);
      EXPECT_THAT(diagnostics.warnings(), testing::ElementsAre(floor, pairs));
    }
}

/// Thousands at one place are millions of pairs: no more than can be counted in a moment are looked for.
TEST(World, OverlapsBeyondTenThousandAreNotCounted) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  for (int i = 0; i < 3000; ++i) scene.body(fmt::format("r{}", i), type, {9, 0, 0, 0.001 * i});
  for (const unsigned threads : {1u, 3u}) {
    Diagnostics diagnostics;
    const World world(scene.spec, test::registry(), {.threads = threads}, diagnostics);
    EXPECT_THAT(diagnostics.warnings(),
                testing::ElementsAre(
                    "warning: more than 10000 pairs of bodies overlap at the start, for example \"r0\" "
                    "and \"r1\"; bodies that overlap may move apart, but not deeper into each other"));
  }
  Diagnostics thorough(true);
  const World world(scene.spec, test::registry(), {.threads = 2}, thorough);
  const std::vector<std::string> lines = thorough.warnings();
  ASSERT_EQ(lines.size(), 101u);
  EXPECT_EQ(lines[0], "warning: \"r0\" overlaps \"r1\" at the start");
  EXPECT_EQ(lines[99], "warning: \"r0\" overlaps \"r100\" at the start");
  EXPECT_EQ(lines[100], "warning: more than 9900 more pairs of bodies overlap at the start");
}

TEST(World, OverlapsThatCanBeCountedAre) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  for (int i = 0; i < 141; ++i) scene.body(fmt::format("r{}", i), type);  // 9,870 pairs
  for (int i = 0; i < 260; ++i) scene.body(fmt::format("s{}", i), type, {5 + 1.0 * (i / 2), 0, 0, 0});
  Diagnostics diagnostics;
  const World exact(scene.spec, test::registry(), {.threads = 2}, diagnostics);
  EXPECT_THAT(diagnostics.warnings(), testing::ElementsAre(testing::StartsWith("warning: 10000 pairs of ")));
  scene.body("t", type);
  Diagnostics more;
  const World many(scene.spec, test::registry(), {.threads = 2}, more);
  EXPECT_THAT(more.warnings(),
              testing::ElementsAre(testing::StartsWith("warning: more than 10000 pairs of ")));
}

TEST(World, OverlappingRobotsMayMoveApartButNotCloser) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  const BodyId a = scene.body("a", type);
  const BodyId b = scene.body("b", type, {0.3, 0, 0, 0});
  World world = scene.world();
  world.set_command(world.view().row(a), {0.5, 0, 0});
  world.step();
  EXPECT_EQ(world.view().pose(a).x, 0);
  world.set_command(world.view().row(a), {});
  world.set_command(world.view().row(b), {0.5, 0, 0});
  world.step();
  EXPECT_DOUBLE_EQ(world.view().pose(b).x, 0.35);
}

TEST(World, ARobotThatStartsInAWallDoesNotDriveThroughIt) {
  for (const double start : {-0.29, -0.25, 0.0}) {  // 1 cm, 5 cm and half of it in a wall 0.2 m thick
    SceneBuilder scene;
    const BodyId robot = scene.body("robot", scene.robot("robot", {box(0.4, 0.4)}), {start, 0, 0, 0});
    scene.wall(-0.1, -2, 0.1, 2);
    World world = scene.world();
    world.set_command(world.view().row(robot), {0.3, 0, 0});
    for (int tick = 0; tick < 10; ++tick) world.step();
    EXPECT_NEAR(world.view().pose(robot).x, start == 0 ? 0.3 : start, 1e-12);
    world.set_command(world.view().row(robot), {-0.3, 0, 0});
    for (int tick = 0; tick < 10; ++tick) world.step();
    EXPECT_EQ(world.view().stalled(world.view().row(robot)), start == 0);
  }
}

TEST(World, UnknownKindsAreErrorsThatNameTheKnownOnes) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  scene[type].drive->kind = "hover";
  scene[type].controllers = {{.kind = "dance", .params = {}, .where = {}}};
  scene.body("r", type);
  Diagnostics diagnostics;
  try {
    const World world(scene.spec, test::registry(), {.threads = 1}, diagnostics);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("error: unknown drive \"hover\"; known: car, diff, omni"));
    EXPECT_THAT(error.what(), testing::HasSubstr("error: unknown controller \"dance\"; known: "));
  }
}

TEST(World, AControllerWithoutItsSensorIsAnError) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  scene[type].controllers = {test::controller("expand")};
  Diagnostics diagnostics;
  EXPECT_THROW(World(scene.spec, test::registry(), {.threads = 1}, diagnostics), InputError);
  EXPECT_EQ(
      diagnostics.text(diagnostics.findings()[0]),
      "error: controller \"expand\" needs a ranger that no other controller of the robot reads; the robot "
      "has no ranger");
}

TEST(World, AControllerIsNotToldToLackASensorThatHasAnError) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  Record beam = test::record(*test::registry().device("ranger")->params.fields[0].record,
                             {{"range_min", 3.0}, {"range_max", 2.0}, {"apply_range_min", true}});
  beam[0] = std::vector<Record>{{0.0, 0.0, 0.1, 0.0}};  // its pose
  scene[type].devices = {
      {.name = "eye", .kind = "ranger", .params = {std::vector<Record>{beam}, false}, .where = {}}};
  scene[type].controllers = {test::controller("expand")};
  Diagnostics diagnostics;
  EXPECT_THROW(World(scene.spec, test::registry(), {.threads = 1}, diagnostics), InputError);
  ASSERT_EQ(diagnostics.findings().size(), 1u);
  EXPECT_THAT(diagnostics.text(diagnostics.findings()[0]),
              testing::StartsWith("error: device \"eye\" has a range_min of 3 m"));
}

TEST(World, NamesAndAliases) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  const BodyId a = scene.body("a", type);
  scene.spec.aliases.push_back({scene.spec.names.add("position:0"), a});
  const World world = scene.world();
  EXPECT_EQ(world.state().names.find("a"), a);
  EXPECT_EQ(world.state().names.find("position:0"), a);
  EXPECT_EQ(world.state().names.find("_ground_model"), BodyId(0));
  EXPECT_FALSE(world.state().names.find("b").valid());
}

TEST(World, EveryPartOfTheStateReachesTheHash) {
  const auto hashes = [](auto&& change) {
    SceneBuilder scene;
    const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
    scene[type].devices = {test::ranger("ir", {{.range_max = 3}})};
    scene[type].controllers = {test::controller("script", {{"law", "wave"}})};
    scene.body("r", type);
    change(scene);
    World world = scene.world();
    for (int i = 0; i < 3; ++i) world.step();
    return world.hashes();
  };
  const Hashes plain = hashes([](SceneBuilder&) {});
  EXPECT_EQ(plain.state, plain.groups[0] + plain.groups[1] + plain.groups[2] + plain.groups[3]);
  const Hashes seen = hashes([](SceneBuilder& s) { s.wall(2, -1, 2.1, 1); });
  EXPECT_EQ(seen.groups[0], plain.groups[0]);
  EXPECT_NE(seen.groups[2], plain.groups[2]) << "a reading changed";
  const Hashes turned = hashes([](SceneBuilder& s) { s.spec.bodies.back().pose_world_body.heading = 1e-9; });
  EXPECT_NE(turned.groups[0], plain.groups[0]);
  const Hashes other = hashes([](SceneBuilder& s) {
    s.spec.types.back().controllers = {test::controller("script", {{"law", "line"}})};
  });
  EXPECT_NE(other.groups[1], plain.groups[1]);
  EXPECT_EQ(other.groups[3], plain.groups[3]) << "both have counted three updates";
}

TEST(World, ThingsThatDoNotMoveAddNothingToTheHash) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  scene.body("r", type);
  World alone = scene.world();
  scene.wall(5, 5, 6, 6);
  World with_wall = scene.world();
  EXPECT_EQ(alone.hashes().state, with_wall.hashes().state);
}

TEST(World, BodiesOfOneWidthLieInOneCellEachHoweverManyThereAre) {
  for (const double edge : {0.1, 0.2, 0.31, 0.4})
    for (int count = 1; count <= 600; count += 37) {
      SceneBuilder scene;
      const TypeId type = scene.robot("robot", {box(edge, edge)});
      for (int i = 0; i < count; ++i) scene.body(fmt::format("r{}", i), type, {i * 1.0, 0, 0, 0});
      World world = scene.world();
      world.step();
      EXPECT_FALSE(world.view().index().has_wide()) << count << " of " << edge << " m";
    }
}

TEST(World, GivenTilesMakeNeitherHugeCellsNorHugeTables) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.2, 0.2)});
  scene[type].devices = {test::ranger("eye", {{.range_max = 1}})};
  for (int i = 0; i < 900; ++i)
    scene.body(fmt::format("r{}", i), type, {100.0 * (i % 30), 100.0 * (i / 30), 0, 0});
  const auto hash = [&](double tile_size_m) {
    World world = scene.world({.threads = 1, .tile_size_m = tile_size_m});
    EXPECT_LE(world.view().index().tiles() * world.view().geometry().cells_per_tile(), 1u << 22)
        << tile_size_m;
    world.step();
    return world.hashes().state;
  };
  const World plain = scene.world({.threads = 1});
  const double cell_m = plain.view().geometry().cell_m;
  const std::uint64_t expected = hash(0);
  for (const double tile_size_m : {1e-300, 1.0, 45.0, 90.0, 1e9, 1e300})
    EXPECT_EQ(hash(tile_size_m), expected);
  EXPECT_EQ(scene.world({.threads = 1, .tile_size_m = 8 * cell_m}).view().geometry().tile_m(), 8 * cell_m);
  EXPECT_LE(scene.world({.threads = 1, .tile_size_m = 1e300}).view().geometry().tile_m(), 2048 * cell_m);
}

TEST(World, AFewWideBodiesDoNotWidenTheCells) {
  const auto scene_with = [](int trucks, double truck_m) {
    SceneBuilder scene;
    const TypeId robot = scene.robot("robot", {box(0.1, 0.1)});
    scene[robot].devices = {test::ranger("eye", {{.range_max = 2, .fov = radians(360), .samples = 8}})};
    for (int i = 0; i < 2500; ++i)
      scene.body(fmt::format("r{}", i), robot, {0.5 * (i % 50), 0.5 * (i / 50), 0, 0});
    const TypeId truck = scene.robot("truck", {box(truck_m, 0.2)});
    for (int i = 0; i < trucks; ++i) scene.body(fmt::format("t{}", i), truck, {12, 24.75 + 0.25 * i, 0, 0});
    return scene;
  };
  const auto cell_m = [](const SceneBuilder& scene) {
    return scene.world({.threads = 1}).view().geometry().cell_m;
  };
  const double of_robots = cell_m(scene_with(0, 1));
  for (const double truck_m : {3.0, 10.0, 30.0, 300.0}) {
    const SceneBuilder scene = scene_with(1, truck_m);
    EXPECT_LT(cell_m(scene), 6 * of_robots) << truck_m;  // an eighth of the wider trucks is more
    // Wide bodies that are not few still do.
    EXPECT_GT(cell_m(scene_with(100, truck_m)), 0.99 * truck_m / 8);
    const auto hash = [&](double tile_size_m) {
      World world = scene.world({.threads = 1, .tile_size_m = tile_size_m});
      for (int i = 0; i < 3; ++i) world.step();
      return world.hashes().state;
    };
    const std::uint64_t expected = hash(0);
    for (const double tile_size_m : {0.3, 5.0, 1e4}) EXPECT_EQ(hash(tile_size_m), expected) << truck_m;
  }
}

#if defined(__SSE2__)
TEST(World, AStepComputesAsPromisedInAThreadSwitchedToFastMaths) {
  const auto run = [] {
    SceneBuilder scene;
    const BodyId body = scene.body("r", scene.robot("robot", {box(0.4, 0.4)}), {1e-310, 0, 0, 0});
    World world = scene.world();
    world.set_command(world.view().row(body), {1e-310, 0, 0.1});
    _mm_setcsr(_mm_getcsr() |
               0x8040);  // flush to zero, denormals are zero: what gcc's -ffast-math start-up does
    world.step();
    const std::uint64_t hash = world.hashes().state;
    std::fesetenv(FE_DFL_ENV);
    return std::pair(hash, world.view().pose(body).x);
  };
  const auto [hash, x] = run();
  EXPECT_GT(x, 1e-310) << "a denormal step was lost";
  EXPECT_NE(hash, 0u);
}
#endif

}  // namespace
}  // namespace troupe::engine::world_test
