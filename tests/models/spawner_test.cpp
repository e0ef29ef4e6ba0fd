#include "models/devices/spawner.hpp"

#include "engine/world/world.hpp"
#include "models/devices/flags.hpp"
#include "models/devices/power.hpp"
#include "models/devices/remover.hpp"
#include "tests/support/devices.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::models::spawner_test {
namespace {

using engine::BirthStatus;
using engine::World;
using test::box;
using test::device;
using test::SceneBuilder;
using ::testing::HasSubstr;

/// A door at x = -1 that bears robots at x = 0, heading up; they drive on at 0.5 m/s.
struct Door {
  SceneBuilder scene;
  TypeId type;
  BodyId door;

  explicit Door(std::vector<engine::DeviceSpec> devices, std::uint32_t reserve = 4) {
    const TypeId frame = scene.type("door", {box(0.4, 0.4)});
    scene[frame].devices = std::move(devices);
    door = scene.body("door", frame, {-1, 0, 0, 0});
    type = scene.robot("bot", {box(0.4, 0.4)});
    scene[type].controllers = {test::drive_legs({test::leg(1e6, 0.5)})};
    scene.spec.reserves = {{"bot", BodyId(scene.spec.bodies.size()), reserve}};
    for (std::uint32_t i = 0; i < reserve; ++i) scene.body(fmt::format("bot{}", i), type);
  }
  const SpawnerState& state(const World& world) const { return test::state_of<SpawnerState>(world, door, 0); }
};

void step(World& world, int ticks) {
  for (int tick = 0; tick < ticks; ++tick) world.step();
}

TEST(Spawner, SpawnsOneEveryPeriodUntilTheReserveIsEmpty) {
  const Door door({device("spawner", {{"population", "bot"}, {"every", 2.0}}, {1, 0, 0, k_pi / 2})}, 3);
  World world = door.scene.world();
  step(world, 19);
  EXPECT_EQ(world.robots(), 0u);
  world.step();  // 2 s
  EXPECT_EQ(world.robots(), 1u);
  EXPECT_EQ(door.state(world).born, 1u);
  EXPECT_EQ(door.state(world).last, world.state().names.find("bot0").value + 1);
  EXPECT_EQ(world.view().birth_tick(world.view().row(world.state().names.find("bot0"))), 20u);
  const Pose pose = world.view().pose(world.state().names.find("bot0"));
  EXPECT_NEAR(pose.x, 0, 1e-15);
  EXPECT_NEAR(pose.y, 0, 1e-15);
  EXPECT_NEAR(pose.heading, k_pi / 2, 1e-15);
  step(world, 20);
  EXPECT_EQ(world.robots(), 2u);
  EXPECT_NEAR(world.view().pose(world.state().names.find("bot0")).y, 0.95, 1e-12)
      << "a tick to decide, 19 to move";
  step(world, 40);
  EXPECT_EQ(world.robots(), 3u);
  EXPECT_EQ(door.state(world).status, static_cast<std::uint8_t>(BirthStatus::used_up));
  EXPECT_EQ(door.state(world).owed, 0u);
}

TEST(Spawner, BirthsThatAreDueEndWithItsBody) {
  Door door({device("spawner", {{"population", "bot"}, {"every", 0.5}}, {1, 0, 0, 0})});
  const TypeId pit = door.scene.type("pit", {box(0.1, 0.1)}, {.obstacle = false});
  door.scene[pit].devices = {device("remover", {{"radius", 0.5}, {"of", "door"}})};
  door.scene.body("pit", pit, {-1, 9, 0, 0});
  World world = door.scene.world();
  step(world, 4);
  world.set_poses(
      std::vector<World::Placed>{{world.view().row(world.state().names.find("pit")), {-1, 0.5, 0, 0}}});
  step(world, 1);  // 0.5 s: a birth is due in the tick in which the remover reaches exactly to the door
  EXPECT_FALSE(world.view().is_there(world.view().row(door.door)));
  EXPECT_EQ(world.robots(), 0u);
  EXPECT_EQ(world.lives().unborn(0), 4u);
}

TEST(Spawner, PeriodsNeedNotBeWholeTicks) {
  for (const auto& [every_s, births] :
       {std::pair(0.25, 40u), {0.15, 66u}, {0.3, 33u}, {0.7, 14u}, {0.01, 100u}}) {
    const Door door(
        {device("spawner", {{"population", "bot"}, {"every", every_s}, {"within", 900.0}}, {1, 0, 0, 0})},
        110);
    World world = door.scene.world();
    step(world, 100);  // 10 s
    EXPECT_EQ(door.state(world).born + door.state(world).owed, births) << every_s;
  }
}

TEST(Spawner, OwesABirthUntilItsPlaceIsFree) {
  Door door({device("spawner", {{"population", "bot"}, {"every", 1.0}}, {1, 0, 0, 0})});
  const BodyId crate = door.scene.body("crate", door.scene.robot("crate", {box(0.4, 0.4)}), {0.3, 0.1, 0, 0});
  World world = door.scene.world();
  step(world, 25);
  EXPECT_EQ(world.robots(), 1u) << "the crate";
  EXPECT_EQ(door.state(world).owed, 2u);
  EXPECT_EQ(door.state(world).refused, 16u) << "ticks 10 to 25";
  EXPECT_EQ(door.state(world).status, static_cast<std::uint8_t>(BirthStatus::occupied));
  world.set_poses(std::vector<World::Placed>{{world.view().row(crate), {9, 9, 0, 0}}});
  world.step();
  EXPECT_EQ(door.state(world).born, 1u);
  EXPECT_EQ(door.state(world).owed, 1u) << "one a tick";
  EXPECT_EQ(world.lives().unborn(0), 3u);
}

/// Gives a flag to body 1 in every fourth tick.
struct Giver {
  static constexpr std::array k_uses{std::string_view("flags")};
  void operator()(const engine::Percept& percept, Random&, engine::Actions& actions) const {
    if (percept.tick % 4 == 1) actions.device<FlagCommand>(0).ask(FlagCommand::give, 1);
  }
};

/// A nest with a spawner of four bots, to which another robot gives a flag in every fourth tick.
struct Nest {
  SceneBuilder scene;
  engine::Registry registry = test::registry();
  BodyId nest;

  explicit Nest(std::int64_t per_flags) {
    registry.controllers.push_back(engine::make_controller_kind<Giver>("giver", ""));
    const TypeId type = scene.type("nest", {box(0.4, 0.4)});
    scene[type].devices = {device("spawner", {{"population", "bot"}, {"per_flags", per_flags}}, {1, 0, 0, 0}),
                           device("flags", {})};
    nest = scene.body("nest", type);
    const TypeId giver = scene.robot("giver", {box(0.2, 0.2)});
    scene[giver].devices = {device("flags", {{"yellow", 20}, {"most", 20}})};
    scene[giver].controllers = {{.kind = "giver", .params = {}}};
    scene.body("giver", giver, {5, 0, 0, 0});
    const TypeId bot = scene.robot("bot", {box(0.2, 0.2)});
    scene.spec.reserves = {{"bot", BodyId(scene.spec.bodies.size()), 4}};
    for (int i = 0; i < 4; ++i) scene.body(fmt::format("bot{}", i), bot);
  }
  World world() const {
    Diagnostics diagnostics;
    return World(scene.spec, registry, {.threads = 1}, diagnostics);
  }
  const SpawnerState& state(const World& world) const { return test::state_of<SpawnerState>(world, nest, 0); }
  /// Changes `per_flags` of the spawner.
  void set(World& world, std::int64_t per_flags) const {
    engine::SettingSpec setting{world.spec().bodies[nest.index()].type, engine::SettingSpec::Of::device, 0,
                                device("spawner", {{"per_flags", per_flags}}).params};
    const auto changed = static_cast<std::size_t>(registry.device("spawner")->params.find("per_flags"));
    for (std::size_t p = 0; p < setting.params.size(); ++p)
      if (p != changed) setting.params[p] = {};
    ASSERT_TRUE(world.set(setting, registry));
  }
};

TEST(Spawner, CountsTheFlagsThatItsBodyIsGiven) {
  const Nest nest(2);
  ASSERT_EQ(nest.nest, BodyId(1));
  World world = nest.world();
  const SpawnerState& state = nest.state(world);
  step(world, 6);  // asked in tick 1, given in 2, counted in 3; the second one is counted in 7
  EXPECT_EQ(state.flags, 1u);
  EXPECT_EQ(state.born, 0u);
  world.step();
  EXPECT_EQ(state.flags, 2u);
  EXPECT_EQ(state.born, 1u);
  EXPECT_EQ(world.robots(), 2u);
  step(world, 8);
  EXPECT_EQ(state.flags, 4u);
  EXPECT_EQ(state.owed, 1u) << "bot0 has not left its place";
  world.remove(world.view().row(world.state().names.find("bot0")));
  world.step();
  EXPECT_EQ(state.born, 2u);
  EXPECT_EQ(state.owed, 0u);
}

TEST(Spawner, CountsNoFlagsOfTheTimeInWhichPerFlagsIsZero) {
  const Nest nest(0);
  World world = nest.world();
  const SpawnerState& state = nest.state(world);
  step(world, 12);  // three flags
  nest.set(world, 2);
  step(world, 6);  // a flag in tick 15
  EXPECT_EQ(state.uncounted, 3u);
  EXPECT_EQ(state.flags, 1u);
  EXPECT_EQ(state.born + state.owed, 0u);
  world.step();
  EXPECT_EQ(state.born, 1u);
  nest.set(world, 0);
  step(world, 8);  // flags in the ticks 23 and 27
  nest.set(world, 2);
  step(world, 8);  // flags in the ticks 31 and 35
  EXPECT_EQ(state.uncounted, 5u);
  EXPECT_EQ(state.flags, 4u);
  EXPECT_EQ(state.born + state.owed, 2u);
}

TEST(Spawner, WithinACircleEachIsBornSomewhereElse) {
  const Door door(
      {device("spawner", {{"population", "bot"}, {"every", 0.1}, {"within", 3.0}}, {11, 0, 0, 0})}, 20);
  World world = door.scene.world();
  step(world, 40);
  EXPECT_EQ(world.robots(), 20u);
  std::set<double> headings;
  for (int i = 0; i < 20; ++i) {
    const engine::World& w = world;
    const Row row = w.view().row(w.state().names.find(fmt::format("bot{}", i)));
    EXPECT_LE((w.view().origin(row) - Vec2(10, 0)).norm(), 3);
    headings.insert(w.view().poses()[row.index()].heading);
  }
  EXPECT_EQ(headings.size(), 20u);
}

TEST(Spawner, ATickOfItsOwnPeriodMissesNoBirth) {
  Door door({device("spawner", {{"population", "bot"}, {"every", 0.2}, {"within", 5.0}}, {11, 0, 0, 0})}, 20);
  door.scene[TypeId(1)].devices[0].period_s = 0.5;
  World world = door.scene.world();
  step(world, 20);  // 2 s: ten births are due, one in each of four ticks
  EXPECT_EQ(door.state(world).born + door.state(world).owed, 10u);
}

TEST(Spawner, ALowerRequestAsksForNoBirth) {
  const Door door({device("spawner", {{"population", "bot"}, {"within", 900.0}}, {1, 0, 0, 0})}, 9);
  World world = door.scene.world();
  const Row row = world.view().row(door.door);
  const auto request = [&](std::uint32_t births) {
    reinterpret_cast<SpawnerCommand*>(world.device_command(row, world.view().type(row).devices[0]))->request =
        births;
    step(world, 4);
    EXPECT_EQ(door.state(world).owed, 0u) << births;
    return door.state(world).born;
  };
  EXPECT_EQ(request(2), 2u);
  EXPECT_EQ(request(0), 2u);
  EXPECT_EQ(request(1), 3u);
  EXPECT_EQ(request(0xffffffff), 3u) << "one less than 0";
  EXPECT_EQ(request(1), 5u);
}

TEST(Spawner, GoesOnWithTheReserveThatAnInterventionSets) {
  Door door({device("spawner", {{"population", "bot"}, {"every", 0.2}, {"within", 5.0}}, {11, 0, 0, 0})}, 2);
  door.scene.spec.reserves.push_back({"other", BodyId(door.scene.spec.bodies.size()), 3});
  for (int i = 0; i < 3; ++i) door.scene.body(fmt::format("other{}", i), door.type);
  engine::InterventionSpec set;
  set.time_s = 1;
  set.action = engine::InterventionSpec::Action::set;
  set.setting = engine::SettingSpec{TypeId(1), engine::SettingSpec::Of::device, 0,
                                    device("spawner", {{"population", "other"}}).params};
  for (std::size_t p = 1; p < set.setting->params.size(); ++p) set.setting->params[p] = {};
  door.scene.spec.experiment.at = {set};
  World world = door.scene.world();
  step(world, 10);
  EXPECT_EQ(world.robots(), 2u) << "the reserve is used up";
  step(world, 10);
  EXPECT_EQ(world.robots(), 5u);
}

TEST(Spawner, OfManyBirthsInOneTickEachSeesTheBodiesBornBefore) {
  constexpr int k_nests = 600;  // so many births that the spatial index is rebuilt between them
  SceneBuilder scene;
  scene.spec.bounds = Box::around(Vec2(75, 0), 80);
  const TypeId nest = scene.type("nest", {box(0.1, 0.1)}, {.obstacle = false});
  scene[nest].devices = {device("spawner", {{"population", "bot"}, {"every", 0.1}})};
  for (int i = 0; i < k_nests; ++i) scene.body(fmt::format("nest{}", i), nest, {0.25 * i, 0, 0, 0});
  const TypeId bot = scene.robot("bot", {box(0.4, 0.4)});
  scene.spec.reserves = {{"bot", BodyId(scene.spec.bodies.size()), k_nests}};
  for (int i = 0; i < k_nests; ++i) scene.body(fmt::format("bot{}", i), bot);
  World world = scene.world();
  world.step();
  ASSERT_EQ(world.robots(), k_nests / 2u) << "a body at every second nest, the others would overlap";
  for (int i = 0; i < k_nests / 2; ++i)
    EXPECT_EQ(world.view().origin(world.view().row(world.state().names.find(fmt::format("bot{}", i)))),
              Vec2(0.5 * i, 0));
}

TEST(Spawner, ErrorsNameThePopulationsThatThereAre) {
  Door door({device("spawner", {{"population", "boot"}})});
  EXPECT_THAT(door.scene.error(), HasSubstr("unknown population with a reserve \"boot\"; known: bot"));
  door.scene.spec.reserves.clear();
  EXPECT_THAT(door.scene.error(), HasSubstr("no population of this world has a \"reserve\""));
  const Door flagless({device("spawner", {{"population", "bot"}, {"per_flags", 1}})});
  EXPECT_THAT(flagless.scene.error(), HasSubstr("has no device of kind \"flags\""));
}

TEST(Remover, EndsTheLivesOfRobotsThatComeToIt) {
  Door door({device("spawner", {{"population", "bot"}, {"every", 1.0}}, {1, 0, 0, 0}),
             device("remover", {{"radius", 0.5}}, {4, 0, 0, 0})});
  const BodyId other = door.scene.body("other", door.scene.robot("other", {box(0.2, 0.2)}), {3.2, 0.4, 0, 0});
  World world = door.scene.world();
  // Of tick 10; its first motion is that of tick 12, and tick 61 takes it to x = 2.5.
  step(world, 61);
  const BodyId first = world.state().names.find("bot0");
  ASSERT_NEAR(world.view().pose(first).x, 2.5, 1e-12);
  EXPECT_EQ(world.view().presence(world.view().row(other)), engine::Presence::dead)
      << "it stood there from the start";
  step(world, 2);
  EXPECT_EQ(world.view().presence(world.view().row(first)), engine::Presence::dead);
  EXPECT_NEAR(world.view().pose(first).x, 2.55, 0.051);
  EXPECT_EQ(test::state_of<RemoverState>(world, door.door, 1).removed, 2u);
}

TEST(Remover, TakesThoseOfItsTypeAlone) {
  Door door({device("remover", {{"radius", 5.0}, {"of", "other"}}, {1, 0, 0, 0})});
  const TypeId other = door.scene.robot("other", {box(0.2, 0.2)});
  const TypeId third = door.scene.robot("third", {box(0.2, 0.2)});
  std::vector<BodyId> others;
  for (int i = 0; i < 20; ++i)
    others.push_back(door.scene.body(fmt::format("o{}", i), other, {0.3 * (i % 5), 1 + 0.3 * (i / 5), 0, 0}));
  const BodyId stays = door.scene.body("t", third, {0, -1, 0, 0});
  World world = door.scene.world();
  world.step();
  EXPECT_EQ(world.robots(), 21u - k_most_removed) << "so many in a tick";
  EXPECT_TRUE(world.view().is_there(world.view().row(others.back()))) << "the lowest ids first";
  world.step();
  EXPECT_EQ(world.robots(), 1u);
  EXPECT_TRUE(world.view().is_there(world.view().row(stays)));

  Door unknown({device("remover", {{"of", "othr"}})});
  EXPECT_THAT(unknown.scene.error(), HasSubstr("unknown type \"othr\"; known: bot, door"));
  Door still({device("remover", {{"of", "wall"}})});
  still.scene.type("wall", {box(1, 1)});
  EXPECT_THAT(still.scene.error(), HasSubstr("would remove bodies of the type \"wall\", which are static"));
}

TEST(Remover, TakesThoseOfATypeThatIsCalledGround) {
  Door door({device("remover", {{"radius", 5.0}, {"of", "ground"}}, {1, 0, 0, 0})});
  const BodyId body = door.scene.body("g", door.scene.robot("ground", {box(0.2, 0.2)}), {0, 1, 0, 0});
  World world = door.scene.world();
  EXPECT_TRUE(world.view().is_there(world.view().row(body)));
  world.step();
  EXPECT_FALSE(world.view().is_there(world.view().row(body)));
}

TEST(Remover, TakesPucksThatNoRobotCarries) {
  SceneBuilder scene;
  const TypeId puck = scene.type("puck", {box(0.1, 0.1, 0.1)}, {.gripper = true});
  const TypeId mill = scene.type("mill", {box(1, 1, 0.01)}, {.obstacle = false, .ranger = -1});
  scene[mill].devices = {device("remover", {{"radius", 1.0}, {"of", "puck"}})};
  scene.body("mill", mill);
  const TypeId type = scene.robot("robot", {box(0.4, 0.4, 0.3)});
  test::add_device(scene[type], "hand", "gripper", {0.3, 0, 0, 0});
  scene[type].controllers = {
      test::operate({test::order(0.1, "hand", "close"), test::order(3, "hand", "open")}),
      test::drive_legs({test::leg(2, 0), test::leg(3, 1)})};
  const BodyId robot = scene.body("r", type, {-2, 0, 0, 0});
  const BodyId held = scene.body("held", puck, {-2 + 0.34, 0, 0, 0});
  const BodyId lying = scene.body("lying", puck, {0, 0.8, 0, 0});
  World world = scene.world();
  step(world, 2);
  EXPECT_FALSE(world.view().is_there(world.view().row(lying)));
  step(world, 28);  // a metre on: the puck is 0.66 m from the mill, and held
  EXPECT_EQ(world.view().carrier(world.view().row(held)), robot);
  EXPECT_TRUE(world.view().is_there(world.view().row(held)));
  step(world, 5);
  EXPECT_FALSE(world.view().is_there(world.view().row(held)));
  EXPECT_TRUE(world.view().is_there(world.view().row(robot))) << "no puck";
}

/// A robot with 1.2 J, which at 1 m/s draws 0.1 J a tick for its drive's idling alone.
struct Mortal {
  SceneBuilder scene;
  BodyId robot;

  Mortal() {
    const TypeId type = scene.robot("bot", {box(0.4, 0.4)});
    scene[type].devices = {device("power_pack", {{"capacity", 1.2}, {"when_empty", "die"}}),
                           device("power_contact", {{"take", 50.0}})};
    robot = scene.body("r", type);
  }
};

TEST(PowerPack, AnEmptyOneMayKillItsBody) {
  Mortal mortal;
  World world = mortal.scene.world();
  world.set_command(world.view().row(mortal.robot), {1, 0, 0});
  step(world, 13);  // rounding leaves a trifle for the last
  EXPECT_TRUE(world.view().is_there(world.view().row(mortal.robot)));
  EXPECT_EQ(test::state_of<PowerPackState>(world, mortal.robot, 0).stored, 0);
  const double x = world.view().pose(mortal.robot).x;
  step(world, 1);
  EXPECT_FALSE(world.view().is_there(world.view().row(mortal.robot)));
  EXPECT_EQ(world.view().pose(mortal.robot).x, x) << "it did not move any more";
}

TEST(PowerPack, WhoIsChargedInTimeLives) {
  Mortal mortal;
  const TypeId dock = mortal.scene.type("dock", {box(0.4, 0.4)}, {.obstacle = false});
  mortal.scene[dock].devices = {device("power_pack", {{"infinite", true}}),
                                device("power_contact", {{"give", 1.5}})};
  mortal.scene.body("dock", dock, {1.5, 0, 0, 0});
  World world = mortal.scene.world();
  world.set_command(world.view().row(mortal.robot), {1, 0, 0});
  step(world, 12);
  world.set_command(world.view().row(mortal.robot), {0, 0, 0});
  step(world, 30);
  EXPECT_TRUE(world.view().is_there(world.view().row(mortal.robot)));
}

}  // namespace
}  // namespace troupe::models::spawner_test
