#include "models/devices/power.hpp"

#include "models/devices/actuator.hpp"
#include "tests/support/devices.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace troupe::models::power_test {
namespace {

using engine::DeviceSpec;
using engine::Value;
using engine::World;
using test::box;
using test::SceneBuilder;

using Values = std::initializer_list<std::pair<std::string_view, Value>>;

DeviceSpec device(const std::string& kind, Values values) {
  return {.name = kind, .kind = kind, .params = test::record(test::registry().device(kind)->params, values)};
}
DeviceSpec pack(Values values) { return device("power_pack", values); }
DeviceSpec contact(double give, double take) {
  return device("power_contact", {{"give", give}, {"take", take}});
}

template <class State>
const State& state_of(const World& world, BodyId body, std::string_view kind) {
  const Row row = world.view().row(body);
  for (const engine::BodyType::Device& d : world.view().type(row).devices)
    if (d.kind->name == kind) return world.tables()[d.table].as<State>(world.view().slot(row));
  throw std::out_of_range(std::string(kind));
}
const PowerPackState& pack_of(const World& world, BodyId body) {
  return state_of<PowerPackState>(world, body, "power_pack");
}

void step(World& world, int ticks) {
  for (int t = 0; t < ticks; ++t) world.step();
}

TEST(Conformance05, AMovingRobotDrawsByItsMassAndSpeeds) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  scene[type].devices = {pack({{"capacity", 1000.0}, {"mass", 2.0}})};
  const BodyId robot = scene.body("r", type);
  World world = scene.world();
  world.set_command(world.view().row(robot), {0.5, 0, 1});
  world.step();
  EXPECT_DOUBLE_EQ(pack_of(world, robot).dissipated, 3.1);  // 1 + 10 * 2 * (0.5 + 1) = 31 W
  EXPECT_DOUBLE_EQ(pack_of(world, robot).stored, 1000 - 3.1);
  step(world, 9);
  EXPECT_NEAR(pack_of(world, robot).dissipated, 31, 1e-12);
}

TEST(PowerPack, FeedsWhatRunsOnIt) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  scene[type].devices = {pack({{"capacity", 100.0}, {"draw", 3.0}, {"idle", 0.0}}),
                         test::ranger("eye", {{}, {}, {}}), test::ranger("unread", {{}})};
  scene[type].devices[2].active = false;
  const BodyId robot = scene.body("r", type);
  World world = scene.world();
  step(world, 10);
  EXPECT_NEAR(pack_of(world, robot).dissipated, 3 + 3 * 0.2, 1e-12);  // W, for a second
}

TEST(PowerPack, EachKindOfSensorDrawsItsOwnPower) {
  const engine::BumperParams strips{.bumpers = {{{0.21, 0, 0, 0}, 0.3}, {{-0.21, 0, 0, k_pi}, 0.3}}};
  const std::vector<std::pair<DeviceSpec, double>> sensors{
      {device("blobfinder", {}), 2},
      {{.name = "bumper", .kind = "bumper", .params = engine::to_record(strips)}, 0.1},
      {device("camera", {}), 100},
      {test::ranger("scanner", {{.fov = 3, .samples = 90}, {.fov = 3, .samples = 30}}), 2 * 0.2},
      {device("fiducial", {}), 0},
      {device("compass", {}), 0}};
  for (const auto& [sensor, watts] : sensors) {
    SceneBuilder scene;
    const TypeId type = scene.type("post", {box(0.4, 0.4)});
    scene[type].devices = {pack({{"capacity", 1000.0}}), sensor};
    scene[type].devices[1].active = true;
    const BodyId post = scene.body("post", type);
    World world = scene.world();
    step(world, 10);
    EXPECT_NEAR(pack_of(world, post).dissipated, watts, 1e-9) << sensor.kind << ", in a second";
  }
}

TEST(PowerPack, ADriveDrawsForSpeedsInAnyDirection) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)}, "omni");
  scene[type].devices = {pack({{"capacity", 1000.0}, {"mass", 2.0}, {"idle", 0.5}})};
  const BodyId robot = scene.body("r", type);
  for (const double sign : {1.0, -1.0}) {
    World world = scene.world();
    world.set_command(world.view().row(robot), {sign * 0.25, sign * 0.5, sign * 0.125});
    world.step();
    EXPECT_NEAR(pack_of(world, robot).dissipated, 0.1 * (0.5 + 10 * 2 * 0.875), 1e-12);
  }
}

TEST(PowerPack, AnActuatorDrawsTwoWattsAndStandsWithoutThem) {
  SceneBuilder scene;
  const TypeId type = scene.type("gate", {box(0.4, 0.4)});
  scene[type].devices = {pack({{"capacity", 100.0}, {"stored", 1.1}})};
  test::add_device(scene[type], "arm", "actuator", {}, {{"max_speed", 0.1}});
  scene[type].controllers = {test::operate({test::order(0, "arm", "go_to", 1)})};
  const BodyId gate = scene.body("g", type);
  World world = scene.world();
  step(world, 5);
  EXPECT_NEAR(pack_of(world, gate).dissipated, 2 * 0.5, 1e-12);
  EXPECT_NEAR(state_of<ActuatorState>(world, gate, "actuator").position, 4 * 0.01, 1e-12);
  step(world, 20);
  EXPECT_EQ(pack_of(world, gate).stored, 0);
  EXPECT_NEAR(state_of<ActuatorState>(world, gate, "actuator").position, 4 * 0.01, 1e-12);
}

TEST(PowerPack, TicksOfAnyLengthDrawTheSame) {
  for (const double tick_s : {0.02, 0.1, 0.25}) {
    SceneBuilder scene;
    scene.spec.tick_s = tick_s;
    const TypeId type = scene.type("lamp", {box(0.4, 0.4)});
    scene[type].devices = {pack({{"capacity", 100.0}, {"draw", 3.0}})};
    const BodyId lamp = scene.body("lamp", type);
    World world = scene.world();
    step(world, static_cast<int>(std::lround(5 / tick_s)));
    EXPECT_NEAR(pack_of(world, lamp).stored, 100 - 15, 1e-9) << tick_s;
  }
}

/// A robot that drives towards a wall at x = 5 and looks at it, with 10 J: 1 W at rest, 0.2 W for its eye.
struct Driver {
  SceneBuilder scene;
  BodyId robot;
  explicit Driver(const std::string& when_empty, double stored = 10) {
    const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
    scene[type].devices = {
        pack({{"capacity", 10.0}, {"stored", stored}, {"mass", 0.0}, {"when_empty", when_empty}}),
        test::ranger("eye", {{.range_max = 8}})};
    robot = scene.body("r", type);
    scene.wall(5, -1, 5.2, 1);
  }
  float range(const World& world) const {
    const Row row = world.view().row(robot);
    return world.tables()[world.view().type(row).devices[1].table].cell<float>(world.view().slot(row), 0)[0];
  }
};

TEST(PowerPack, RunningEmptyStopsDriveAndSensors) {
  Driver driver("stop", 0.6);  // enough for 5 ticks of 0.12 J
  World world = driver.scene.world();
  world.set_command(world.view().row(driver.robot), {1, 0, 0});
  step(world, 5);
  EXPECT_NEAR(world.view().pose(driver.robot).x, 0.5, 1e-12);
  step(world, 2);
  EXPECT_EQ(pack_of(world, driver.robot).stored, 0);
  const double x = world.view().pose(driver.robot).x;
  const float range = driver.range(world);
  step(world, 5);
  EXPECT_EQ(world.view().pose(driver.robot).x, x);
  EXPECT_EQ(driver.range(world), range);
  EXPECT_EQ(world.view().velocities()[world.view().row(driver.robot).index()].x, 0);
  EXPECT_NEAR(pack_of(world, driver.robot).dissipated, 0.6, 1e-12);
}

TEST(PowerPack, AsInStageRunningEmptyCanBeWithoutEffect) {
  Driver driver("nothing", 0.6);
  World world = driver.scene.world();
  world.set_command(world.view().row(driver.robot), {1, 0, 0});
  step(world, 20);
  EXPECT_NEAR(world.view().pose(driver.robot).x, 2, 1e-12);
  EXPECT_NEAR(driver.range(world), 5 - 1.9, 1e-6);
  EXPECT_EQ(pack_of(world, driver.robot).stored, 0);
}

TEST(PowerPack, AnInfiniteOneNeverRunsOut) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  scene[type].devices = {pack({{"infinite", true}, {"mass", 100.0}})};
  const BodyId robot = scene.body("r", type);
  World world = scene.world();
  world.set_command(world.view().row(robot), {1, 0, 0});
  step(world, 10);
  EXPECT_NEAR(world.view().pose(robot).x, 1, 1e-12);
  EXPECT_NEAR(pack_of(world, robot).dissipated, 1001, 1e-9);
  EXPECT_EQ(pack_of(world, robot).proportion_remaining(), 1);
}

/// A charger at the origin, 0.4 m wide, and takers about it.
struct Station {
  SceneBuilder scene;
  TypeId giver, taker;
  BodyId charger;
  Station(double give, Values giver_pack, double take, Values taker_pack) {
    giver = scene.type("charger", {box(0.4, 0.4)}, {.obstacle = false});
    scene[giver].devices = {pack(giver_pack), contact(give, 0)};
    taker = scene.type("battery", {box(0.2, 0.2)});
    scene[taker].devices = {pack(taker_pack), contact(0, take)};
    charger = scene.body("charger", giver);
  }
};

TEST(PowerContact, GivesToWhatTouchesAtTheSlowerRate) {
  Station station(20, {{"infinite", true}}, 5, {{"capacity", 100.0}, {"stored", 10.0}});
  const BodyId touching = station.scene.body("a", station.taker, {0.31, 0, 0, 0});
  const BodyId apart = station.scene.body("b", station.taker, {-0.33, 0, 0, 0});
  const BodyId above = station.scene.body("c", station.taker, {0, 0.31, 7, 0});
  const BodyId within = station.scene.body("d", station.taker, {0, 0, 0, 0.7});
  World world = station.scene.world();
  step(world, 10);
  for (const BodyId body : {touching, above, within}) {
    EXPECT_NEAR(pack_of(world, body).stored, 15, 1e-12) << body.value;
    EXPECT_EQ(pack_of(world, body).charging, 1);
  }
  EXPECT_EQ(pack_of(world, apart).stored, 10);
  EXPECT_EQ(pack_of(world, apart).charging, 0);
  EXPECT_NEAR(pack_of(world, station.charger).given, 15, 1e-12);
  EXPECT_EQ(state_of<PowerContactState>(world, station.charger, "power_contact").touched, 3);
}

/// Givers of lower and of higher ids than the taker, which drives off: what it reads as it decides is whether
/// the tick before gave it something, and so is what others read between ticks.
TEST(PowerContact, ControllersSeeThatTheirPackIsCharged) {
  for (const bool giver_first : {true, false}) {
    SceneBuilder scene;
    const TypeId giver = scene.type("charger", {box(0.4, 0.4)}, {.obstacle = false});
    scene[giver].devices = {pack({{"infinite", true}}), contact(20, 0)};
    const TypeId taker = scene.robot("robot", {box(0.2, 0.2)});
    scene[taker].devices = {pack({{"capacity", 100.0}, {"stored", 10.0}}), contact(0, 20)};
    scene[taker].controllers = {test::drive_legs({test::leg(0.5, 0), test::leg(20, 0.5)})};
    if (giver_first) scene.body("charger", giver);
    const BodyId robot = scene.body("robot", taker);
    if (!giver_first) scene.body("charger", giver);
    World world = scene.world({.threads = 1});
    bool was_given = false;
    int ticks_seen = 0;
    world.on_decide([&](const auto&, const auto& controller, const engine::DecideBatch& batch) {
      EXPECT_EQ(pack_of(world, robot).charging != 0, was_given) << "tick " << world.tick();
      ticks_seen += was_given;
      controller.kind->decide(controller.data, batch);
    });
    for (int t = 0; t < 30; ++t) {
      const double received = pack_of(world, robot).received;
      world.step();
      was_given = pack_of(world, robot).received > received;
      EXPECT_EQ(pack_of(world, robot).charging != 0, was_given) << "tick " << t;
    }
    EXPECT_GT(ticks_seen, 5);
    EXPECT_FALSE(was_given);
  }
}

TEST(PowerContact, GivesNoMoreThanThereIsRoomForAndThanItHolds) {
  Station full(20, {{"infinite", true}}, 20, {{"capacity", 100.0}, {"stored", 99.5}});
  const BodyId nearly_full = full.scene.body("a", full.taker, {0.3, 0, 0, 0});
  World world = full.scene.world();
  step(world, 3);
  EXPECT_EQ(pack_of(world, nearly_full).stored, 100);
  EXPECT_EQ(pack_of(world, nearly_full).charging, 0);

  // 3 J for two that take 2 J a tick each: the lower id comes first, and then there is nothing left.
  Station scarce(20, {{"capacity", 3.0}}, 20, {{"capacity", 100.0}, {"stored", 0.0}});
  const BodyId first = scarce.scene.body("a", scarce.taker, {0.3, 0, 0, 0});
  const BodyId second = scarce.scene.body("b", scarce.taker, {-0.3, 0, 0, 0});
  World poor = scarce.scene.world();
  step(poor, 3);
  EXPECT_EQ(pack_of(poor, first).stored, 2);
  EXPECT_EQ(pack_of(poor, second).stored, 1);
  EXPECT_EQ(pack_of(poor, scarce.charger).stored, 0);
}

TEST(PowerContact, AnEmptyRobotThatIsChargedGoesOn) {
  Driver driver("stop", 0);
  driver.scene[driver.scene.spec.bodies[driver.robot.index()].type].devices.push_back(contact(0, 5));
  const TypeId giver = driver.scene.type("charger", {box(0.4, 0.4)}, {.obstacle = false});
  driver.scene[giver].devices = {pack({{"infinite", true}}), contact(5, 0)};
  driver.scene.body("charger", giver, {-0.3, 0, 0, 0});
  World world = driver.scene.world();
  world.set_command(world.view().row(driver.robot), {1, 0, 0});
  step(world, 1);
  EXPECT_EQ(world.view().pose(driver.robot).x, 0);
  step(world, 3);
  EXPECT_GT(world.view().pose(driver.robot).x, 0.1);
}

TEST(PowerContact, ServesTheLowestIdsOfManyWhateverTheThreads) {
  const auto run = [](unsigned threads, double tile_size_m) {
    Station station(20, {{"infinite", true}}, 5, {{"capacity", 100.0}, {"stored", 10.0}});
    for (int i = 0; i < 20; ++i)
      station.scene.body("b" + std::to_string(i), station.taker, {0.01 * i, 0.3 - 0.02 * i, 0, 0.3 * i});
    World world = station.scene.world({.threads = threads, .tile_size_m = tile_size_m});
    step(world, 10);
    for (std::uint32_t i = 0; i < 20; ++i)
      EXPECT_EQ(pack_of(world, BodyId(2 + i)).received > 0, i < k_most_takers) << i;
    return world.hashes().state;
  };
  const std::uint64_t hash = run(1, 0);
  EXPECT_EQ(run(2, 0.5), hash);
  EXPECT_EQ(run(8, 0), hash);
}

TEST(PowerContact, NeedsAPack) {
  SceneBuilder scene;
  const TypeId type = scene.type("charger", {box(0.4, 0.4)});
  scene[type].devices = {contact(5, 0)};
  scene.body("charger", type);
  EXPECT_THAT(
      test::message_of<InputError>([&] { scene.world(); }),
      ::testing::HasSubstr("\"power_contact\" (power_contact) has no power supply: add a power_pack"));
}

}  // namespace
}  // namespace troupe::models::power_test
