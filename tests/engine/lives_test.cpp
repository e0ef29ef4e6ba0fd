// Births and deaths: unborn and dead bodies have no effect on others, a newborn body has the state of a body
// at tick 0, and the results do not depend on threads.

#include "base/random.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/links/effect_views.hpp"
#include "engine/observing/displacement.hpp"
#include "engine/observing/events.hpp"
#include "engine/observing/frame.hpp"
#include "engine/world/world.hpp"
#include "models/devices/gripper.hpp"
#include "tests/support/devices.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/slow_build.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace troupe::engine::lives_test {
namespace {

using test::box;
using test::Moody;
using test::SceneBuilder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::uint32_t k_reserve = 3;

void add_reserve(SceneBuilder& scene, const std::string& name, TypeId type, std::uint32_t count) {
  scene.spec.reserves.push_back({name, BodyId(scene.spec.bodies.size()), count});
  for (std::uint32_t i = 0; i < count; ++i) scene.body(fmt::format("{}{}", name, i), type);
}

/// A robot that looks ahead, at x = 0, and a reserve of others like it.
struct Plain {
  SceneBuilder scene;
  TypeId type;
  BodyId robot;

  Plain() {
    type = scene.robot("bot", {box(0.4, 0.4)});
    scene[type].devices = {test::ranger("eye", {{.range_max = 5}})};
    robot = scene.body("r", type);
    add_reserve(scene, "more", type, k_reserve);
  }
  static float range(const World& world, BodyId body) {
    const Row row = world.view().row(body);
    return world.tables()[world.view().type(row).devices[0].table].cell<float>(world.view().slot(row), 0)[0];
  }
};

TEST(Lives, WhoIsInReserveIsNowhere) {
  Plain plain;
  World world = plain.scene.world();
  const Row unborn = world.view().row(world.state().names.find("more0"));
  EXPECT_EQ(world.view().rows(), 1u + k_reserve);
  EXPECT_EQ(world.robots(), 1u);
  EXPECT_EQ(world.view().absent_count(), k_reserve);
  EXPECT_EQ(world.view().presence(unborn), Presence::unborn);
  EXPECT_FALSE(world.view().is_there(unborn));
  EXPECT_TRUE(std::isnan(world.view().pose(world.state().names.find("more0")).x));
  EXPECT_EQ(world.view().index().order().size(), 1u);
  EXPECT_EQ(engine::make_frame(world).mobile.size(), 1u);
  world.set_command(world.view().row(plain.robot), {1, 0, 0});
  for (int tick = 0; tick < 10; ++tick) world.step();
  EXPECT_NEAR(world.view().pose(plain.robot).x, 1, 1e-12) << "they do not stand in anybody's way";
  EXPECT_EQ(Plain::range(world, plain.robot), 5) << "nor are they seen";
  EXPECT_EQ(world.counters().beams, 10u) << "nor do they see";
  EXPECT_EQ(engine::mean_displacement(world), world.view().pose(plain.robot).x);
}

TEST(Lives, AWorldWithoutThemHasNoSuchComponentAndNoDeaths) {
  SceneBuilder scene;
  const BodyId robot = scene.body("r", scene.robot("bot", {box(0.4, 0.4)}));
  World world = scene.world();
  EXPECT_FALSE(world.view().has_lives());
  EXPECT_EQ(
      test::message_of<std::logic_error>([&] { world.remove(world.view().row(robot)); }),
      "programs cannot remove bodies of this world: add \"mortal\": true to the world file, or set this key "
      "when you load the world (in C++: SimulationOptions::mortal; in Python: set={\"/mortal\": True}); "
      "worlds with a \"reserve\", a device that removes bodies, or an intervention \"remove\" need neither");
  const std::uint64_t hash = world.hashes().state;

  scene.spec.mortal = true;
  World mortal = scene.world();
  EXPECT_EQ(mortal.hashes().state, hash) << "bodies present at tick 0 add nothing";
  mortal.remove(mortal.view().row(robot));
  EXPECT_NE(mortal.hashes().state, hash);
  EXPECT_EQ(mortal.robots(), 0u);
}

TEST(Lives, BornBodiesAreSeenMetAndMoved) {
  Plain plain;
  World world = plain.scene.world();
  world.step();
  const Birth birth = world.spawn(0, {2, 0, 0, k_pi});
  ASSERT_EQ(birth.status, BirthStatus::born);
  EXPECT_EQ(birth.body, world.state().names.find("more0"));
  const Row row = world.view().row(birth.body);
  EXPECT_TRUE(world.view().is_there(row));
  EXPECT_EQ(world.view().birth_tick(row), 1u);
  EXPECT_EQ(world.view().origin(row), Vec2(2, 0));
  EXPECT_EQ(world.robots(), 2u);
  EXPECT_EQ(world.lives().unborn(0), k_reserve - 1);
  EXPECT_EQ(engine::make_frame(world).mobile.size(), 2u);
  EXPECT_EQ(Plain::range(world, birth.body), 0) << "it has not looked yet";
  world.step();
  EXPECT_FLOAT_EQ(Plain::range(world, plain.robot), 1.8f);
  EXPECT_FLOAT_EQ(Plain::range(world, birth.body), 1.8f);
  world.set_command(world.view().row(plain.robot), {1, 0, 0});
  for (int tick = 0; tick < 30; ++tick) world.step();
  EXPECT_TRUE(world.view().stalled(world.view().row(plain.robot)));
  EXPECT_LE(world.view().pose(plain.robot).x, 1.6 + 1e-9);
}

TEST(Lives, ANewbornBodyHasItsPlaceAndAHeadingWithinHalfATurn) {
  Plain plain;
  World world = plain.scene.world();
  const BodyId born = world.spawn(0, {2, -1.5, 0.25, 4}).body;
  EXPECT_EQ(world.view().pose(born), (Pose{2, -1.5, 0.25, wrap_angle(4)}));
  EXPECT_EQ(world.view().origin(world.view().row(born)), Vec2(2, -1.5));
  world.step();
  EXPECT_EQ(world.view().pose(born), (Pose{2, -1.5, 0.25, wrap_angle(4)}));
}

TEST(Lives, OnlyBodiesWithADriveCountAsRobots) {
  Plain plain;
  plain.scene.spec.mortal = true;
  const BodyId puck =
      plain.scene.body("puck", plain.scene.type("puck", {box(0.1, 0.1)}, {.gripper = true}), {2, 2, 0, 0});
  World world = plain.scene.world();
  EXPECT_EQ(world.robots(), 1u);
  world.set_command(world.view().row(plain.robot), {1, 0, 0});
  for (int tick = 0; tick < 5; ++tick) world.step();
  world.remove(world.view().row(puck));
  EXPECT_EQ(world.robots(), 1u);
  ASSERT_EQ(world.spawn(0, {3, 3, 0, 0}).status, BirthStatus::born);
  EXPECT_EQ(world.robots(), 2u);
  EXPECT_NEAR(engine::mean_displacement(world), 0.25, 1e-12) << "0.5 m, and 0 m of the newborn robot";
  world.remove(world.view().row(plain.robot));
  EXPECT_EQ(world.robots(), 1u);
  EXPECT_EQ(engine::mean_displacement(world), 0) << "the dead count no more";
}

TEST(Lives, ACommandBeforeTheBirthHasNoEffectAfterIt) {
  Plain plain;
  World world = plain.scene.world();
  world.set_command(world.view().row(world.state().names.find("more0")), {1, 0, 0});
  const Birth birth = world.spawn(0, {2, 0, 0, 0});
  ASSERT_EQ(birth.status, BirthStatus::born);
  world.step();
  world.step();
  EXPECT_EQ(world.view().pose(birth.body).x, 2);
}

TEST(Lives, NoEstimateIsSetOfWhoIsNotThere) {
  SceneBuilder scene;
  const TypeId type = scene.robot("bot", {box(0.4, 0.4)});
  scene[type].drive = test::drive("diff", {{"localization", "odom"}});
  const BodyId robot = scene.body("r", type);
  add_reserve(scene, "more", type, 1);
  World world = scene.world();
  const std::uint64_t hash = world.hashes().state;
  EXPECT_THROW(world.set_estimate(world.view().row(world.state().names.find("more0")), {1, 2, 0, 3}),
               std::logic_error);
  EXPECT_EQ(world.hashes().state, hash);
  world.remove(world.view().row(robot));
  EXPECT_THROW(world.set_estimate(world.view().row(robot), {1, 2, 0, 3}), std::logic_error);
}

TEST(Lives, WhoIsNotThereIsNotPlaced) {
  Plain plain;
  World world = plain.scene.world();
  const World::Placed unborn{world.view().row(world.state().names.find("more0")), {3, 0, 0, 0}};
  EXPECT_EQ(test::message_of<std::invalid_argument>([&] {
              world.set_poses({&unborn, 1});
            }),
            "\"more0\" cannot be placed: it was removed from the world, or has not been added to it yet");
  world.remove(world.view().row(plain.robot));
  const World::Placed dead{world.view().row(plain.robot), {3, 0, 0, 0}};
  EXPECT_THROW(world.set_poses({&dead, 1}), std::invalid_argument);
}

TEST(Lives, ABirthNeedsAFreePlaceInTheWorldAndAnUnbornBody) {
  Plain plain;
  plain.scene.wall(3, -1, 4, 1);
  plain.scene.spec.bounds = Box::around(Vec2::Zero(), 10);
  World world = plain.scene.world();
  const std::uint64_t before = world.hashes().state;
  EXPECT_EQ(world.spawn(0, {0.39, 0, 0, 0}).status, BirthStatus::occupied) << "the robot";
  EXPECT_EQ(world.spawn(0, {3.5, 0, 0, 0}).status, BirthStatus::occupied) << "in the wall";
  EXPECT_EQ(world.spawn(0, {2.9, 0, 0, 0}).status, BirthStatus::occupied) << "its edge";
  EXPECT_EQ(world.spawn(0, {11, 0, 0, 0}).status, BirthStatus::occupied) << "outside";
  EXPECT_THROW(world.spawn(0, {std::nan(""), 0, 0, 0}), std::invalid_argument);
  EXPECT_EQ(world.hashes().state, before) << "a failed birth changes nothing";
  EXPECT_EQ(world.lives().unborn(0), k_reserve);
  EXPECT_EQ(world.spawn(0, {0.4, 0, 0, 0}).body, world.state().names.find("more0")) << "touching is free";
  EXPECT_EQ(world.spawn(0, {0.4, 0, 0, 0}).status, BirthStatus::occupied) << "by the one before";
  EXPECT_EQ(world.spawn(0, {-1, 0, 0, 0}).body, world.state().names.find("more1"));
  EXPECT_EQ(world.spawn(0, {-2, 0, 0, 0}).body, world.state().names.find("more2"));
  EXPECT_EQ(world.spawn(0, {-3, 0, 0, 0}).status, BirthStatus::used_up);
  world.remove(world.view().row(world.state().names.find("more2")));
  EXPECT_EQ(world.spawn(0, {-2, 0, 0, 0}).status, BirthStatus::used_up) << "no id is used twice";
}

TEST(Lives, TheDeadAreGoneAndKeepNothingButTheirPlace) {
  Plain plain;
  World world = plain.scene.world();
  const BodyId other = world.spawn(0, {2, 0, 0, 0}).body;
  world.set_command(world.view().row(other), {1, 0, 0});
  for (int tick = 0; tick < 5; ++tick) world.step();
  const Row row = world.view().row(other);
  world.remove(row);
  EXPECT_EQ(world.view().presence(row), Presence::dead);
  EXPECT_NEAR(world.view().pose(other).x, 2.5, 1e-12);
  EXPECT_EQ(world.view().velocities()[row.index()].x, 0);
  EXPECT_EQ(world.view().commands()[row.index()].x, 0);
  EXPECT_EQ(Plain::range(world, other), 0);
  const std::uint64_t hash = world.hashes().state;
  world.remove(row);  // nothing more happens
  EXPECT_EQ(world.hashes().state, hash);
  world.step();
  EXPECT_EQ(Plain::range(world, plain.robot), 5);
  EXPECT_NEAR(world.view().pose(other).x, 2.5, 1e-12);
  EXPECT_THROW(world.set_poses(std::vector<World::Placed>{{row, {1, 1, 0, 0}}}), std::invalid_argument);
  EXPECT_TRUE(world.is_free(world.view().row(plain.robot), {2.5, 0, 0, 0}));
}

/// Counts its decisions, a device and a drive of 0.3 s each.
struct Counter {
  struct Memory {
    std::uint32_t decisions = 0;
    std::uint64_t first_tick = 0;
    TROUPE_FIELDS(decisions, first_tick)
  };
  void operator()(Memory& memory, const Percept& percept, Random&, Actions&) const {
    if (memory.decisions++ == 0) memory.first_tick = percept.tick;
  }
};

TEST(Lives, PeriodsCountFromTheBirth) {
  Registry registry = test::registry();
  registry.controllers.push_back(make_controller_kind<Counter>("counter", ""));
  SceneBuilder scene;
  const TypeId type = scene.robot("bot", {box(0.4, 0.4)});
  scene[type].devices = {test::ranger("eye", {{.range_max = 5}})};
  scene[type].devices[0].period_s = 0.3;
  scene[type].controllers = {{.kind = "counter", .params = {}}};
  scene.body("r", type);
  add_reserve(scene, "more", type, 2);
  Diagnostics diagnostics;
  World world(scene.spec, registry, {.threads = 1}, diagnostics);
  const auto memory = [&](std::string_view name) -> const Counter::Memory& {
    const Row row = world.view().row(world.state().names.find(name));
    return world.tables()[*world.view().type(row).controllers[0].table].as<Counter::Memory>(
        world.view().slot(row));
  };
  for (int tick = 0; tick < 4; ++tick) world.step();
  world.spawn(0, {2, 0, 0, 0});
  for (int tick = 0; tick < 8; ++tick) world.step();  // tick 12, and 8 of its life
  EXPECT_EQ(memory("r").first_tick, 3u);
  EXPECT_EQ(memory("r").decisions, 4u);
  EXPECT_EQ(memory("more0").first_tick, 7u);
  EXPECT_EQ(memory("more0").decisions, 2u);
  EXPECT_EQ(memory("more1").decisions, 0u);
}

TEST(Lives, WhatTheDeadCarriedLiesWhereItWas) {
  SceneBuilder scene;
  scene.spec.mortal = true;
  const TypeId type = scene.robot("bot", {box(0.4, 0.4, 0.3)});
  const std::size_t hand = test::add_device(scene[type], "hand", "gripper", {0.3, 0, 0, 0});
  scene[type].controllers = {test::operate({test::order(0.1, "hand", "close")})};
  const BodyId robot = scene.body("r", type);
  const TypeId puck = scene.type("puck", {box(0.1, 0.1, 0.1)}, {.gripper = true});
  const BodyId object = scene.body("o", puck, {0.34, 0, 0, 0});
  for (const bool robot_dies : {true, false}) {
    World world = scene.world();
    for (int tick = 0; tick < 20; ++tick) world.step();
    ASSERT_EQ(world.view().carrier(world.view().row(object)), robot);
    world.set_command(world.view().row(robot), {0.2, 0, 0.1});
    for (int tick = 0; tick < 10; ++tick) world.step();
    const Pose at = world.view().pose(object);
    const double x = world.view().pose(robot).x;
    world.remove(world.view().row(robot_dies ? robot : object));
    EXPECT_FALSE(world.view().carrier(world.view().row(object)));
    EXPECT_EQ(world.view().counts().carried, 0u);
    world.step();
    EXPECT_EQ(world.view().pose(object), at);
    if (robot_dies) continue;
    EXPECT_EQ(test::state_of<models::GripperState>(world, robot, hand).held, 0u) << "it knows";
    EXPECT_GT(world.view().pose(robot).x, x) << "and drives on";
  }
}

TEST(Lives, BodiesWithJointsAreBornAsTheyStart) {
  SceneBuilder scene;
  const TypeId type = scene.robot("bot", {box(0.4, 0.4, 0.3)});
  test::add_device(scene[type], "hand", "gripper", {0.3, 0, 0, 0}, {{"paddles", std::string("closed")}});
  const BodyId model = scene.body("r", type, {0, 0, 0, 0.5});
  add_reserve(scene, "more", type, 1);
  World world = scene.world();
  world.step();
  const BodyId born = world.spawn(0, {5, 1, 0, 0.5}).body;
  ASSERT_TRUE(born.valid());
  const auto first = world.view().outline(world.view().row(model));
  const auto second = world.view().outline(world.view().row(born));
  for (std::size_t v = 0; v < first.size(); ++v) EXPECT_LT((second[v] - first[v] - Vec2(5, 1)).norm(), 1e-12);
  EXPECT_EQ(test::state_of<models::GripperState>(world, born, 0).paddles, models::GripperState::closed);
}

TEST(Lives, EventsTellOfBirthsAndDeaths) {
  Plain plain;
  World world = plain.scene.world();
  EventWatch watch(world);
  const auto next = [&] {
    world.step();
    std::vector<std::string> lines;
    for (const Event& event : watch.see(world))
      lines.push_back(fmt::format("{} {}", event_name(event.type), world.spec().name(event.body)));
    return lines;
  };
  EXPECT_THAT(next(), IsEmpty());
  world.spawn(0, {2, 0, 0, 0});
  world.spawn(0, {-2, 0, 0, 0});
  EXPECT_THAT(next(), ElementsAre("birth more0", "birth more1"));
  world.remove(world.view().row(world.state().names.find("more0")));
  EXPECT_THAT(next(), ElementsAre("death more0"));
  world.spawn(0, {2, 0, 0, 0});
  world.remove(world.view().row(world.state().names.find("more2")));
  EXPECT_THAT(next(), ElementsAre("birth more2", "death more2"));
  EXPECT_THAT(next(), IsEmpty());
}

// A body whose birth failed half-way must not stay in the world, although the callback knows of its failure.
TEST(Lives, ABirthThatFailedInACallbackLeavesNoWorldToGoOnWith) {
  Registry registry = test::registry();
  registry.devices.push_back(Moody::kind());
  Plain plain;
  plain.scene[plain.type].devices.push_back({.name = "moody", .kind = "moody", .params = {}, .where = {}});
  Diagnostics diagnostics;
  World world(plain.scene.spec, registry, {.threads = 1}, diagnostics);
  int failed = 0;
  world.before_tick([&] {
    try {
      world.spawn(0, {5, 5, 0, 0});
    } catch (const StepError&) {
      ++failed;
    }
  });
  Moody::throws = true;
  EXPECT_THROW(world.step(), std::logic_error);
  EXPECT_EQ(failed, 1);
  EXPECT_THROW(world.step(), std::logic_error);
  Moody::throws = false;
  world.reset();
  world.step();
  EXPECT_EQ(world.lives().unborn(0), k_reserve - 1);
}

TEST(Lives, AReserveOfBodiesThatDoNothingIsRefused) {
  SceneBuilder scene;
  const TypeId crate = scene.type("crate", {box(0.4, 0.4)});
  add_reserve(scene, "c", crate, 2);
  Diagnostics diagnostics;
  EXPECT_THAT(test::message_of<InputError>(
                  [&] { World world(scene.spec, test::registry(), {.threads = 1}, diagnostics); }),
              HasSubstr("the reserve of population \"c\" needs a type that"));
}

TEST(Lives, ASecondReserveOfAPopulationIsRefused) {
  Plain plain;
  add_reserve(plain.scene, "other", plain.type, 2);
  EXPECT_EQ(plain.scene.error(), "");
  add_reserve(plain.scene, "more", plain.type, 2);
  EXPECT_THAT(plain.scene.error(),
              HasSubstr("here begins a second reserve of population \"more\", but only the bodies"));
}

// ---- many births and deaths in crowded ticks

/// Now and then asks for a birth beside it, or dies, or kills whom it finds nearest.
struct Breeder {
  struct State {
    std::uint32_t born = 0;
    std::uint32_t occupied = 0;
    std::uint32_t used_up = 0;
    std::uint32_t last = 0;
    TROUPE_FIELDS(born, occupied, used_up, last)
  };

  static DeviceKind kind() {
    DeviceKind kind{.name = "breeder", .text = ""};
    kind.prepare = [](const Record&, const Pose&) {
      return DeviceKind::Prepared{.data = 0,
                                  .percepts = memory_fields<State>(),
                                  .percept_bytes = sizeof(State),
                                  .most_effects = 2,
                                  .ends_lives = true};
    };
    kind.act = [](const DeviceBatch& batch) {
      for (std::size_t i = 0; i < batch.rows.size(); ++i) {
        Random random = batch.random(i);
        const Pose at = batch.mount(i).pose();
        if (random.uniform() < 0.3)
          batch.emit_birth(i, 0, 0,
                           {at.x + random.uniform(-0.6, 0.6), at.y + random.uniform(-0.6, 0.6), 0, 1});
        if (random.uniform() < 0.1) batch.emit_death(i, 1, batch.body(i));
      }
    };
    kind.born = [](const EffectContext& context, const std::any&, const Effect&, const Birth& birth) {
      auto& own = OwnDevice(context).state<State>();
      own.born += birth.status == BirthStatus::born;
      own.occupied += birth.status == BirthStatus::occupied;
      own.used_up += birth.status == BirthStatus::used_up;
      if (birth.body.valid()) own.last = birth.body.value;
    };
    return kind;
  }
  static const State& state(const World& world, BodyId body) {
    const Row row = world.view().row(body);
    return world.tables()[world.view().type(row).devices.front().table].as<State>(world.view().slot(row));
  }
};

/// Bots that move about, breed and die in a yard, with rangers.
class Yard {
 public:
  static constexpr std::uint32_t k_more = test::k_slow_build ? 60 : 300;

  explicit Yard(const WorldOptions& options, RangingEngine ranging = RangingEngine::exact) {
    registry_.devices.push_back(Breeder::kind());
    const TypeId type = scene_.robot("bot", {box(0.3, 0.3, 0.3)}, "omni");
    scene_[type].devices = {{.name = "womb", .kind = "breeder", .params = {}, .where = {}},
                            test::ranger("eye", {{.range_max = 2}})};
    scene_[type].devices[1].period_s = 0.2;
    for (int i = 0; i < 30; ++i)
      scene_.body(fmt::format("r{}", i), type, {0.4 * (i % 6), 0.4 * (i / 6), 0, 0});
    add_reserve(scene_, "more", type, k_more);
    scene_.wall(-2, -2, 4, -1.9);
    scene_.spec.bounds = Box::around(Vec2(1, 1), 3);
    scene_.spec.ranging = ranging;
    scene_.spec.resolution_m = 0.05;
    Diagnostics diagnostics;
    world_ = std::make_unique<World>(scene_.spec, registry_, options, diagnostics);
  }
  World& world() { return *world_; }
  void step() {
    for (std::size_t r = 0; r < world_->view().rows(); ++r) {
      const Row row(r);
      if (!world_->view().is_there(row) || !world_->view().type(row).drive) continue;
      Random random(7, 1, world_->view().body(row).value, static_cast<std::uint32_t>(world_->tick()));
      world_->set_command(row, {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
    }
    world_->step();
  }

 private:
  Registry registry_ = test::registry();
  SceneBuilder scene_;
  std::unique_ptr<World> world_;
};

constexpr int k_ticks = test::k_slow_build ? 12 : 60;

std::vector<std::uint64_t> hashes_of(const WorldOptions& options,
                                     RangingEngine ranging = RangingEngine::exact) {
  Yard yard(options, ranging);
  std::vector<std::uint64_t> hashes{yard.world().hashes().state};
  for (int tick = 0; tick < k_ticks; ++tick) {
    yard.step();
    hashes.push_back(yard.world().hashes().state);
  }
  return hashes;
}

TEST(Lives, TheSameAreBornAndDieOnAnyThreadsAndTiles) {
  for (const RangingEngine ranging : {RangingEngine::exact, RangingEngine::grid}) {
    const auto expected = hashes_of({.threads = 1}, ranging);
    EXPECT_EQ(hashes_of({.threads = 2, .tile_size_m = 0.9}, ranging), expected);
    EXPECT_EQ(hashes_of({.threads = 8, .tile_size_m = 30}, ranging), expected);
  }
}

TEST(Lives, AcrossAllBirthsAndDeathsNoRobotOverlapsAndNoneIsLost) {
  Yard yard({.threads = 2});
  World& world = yard.world();
  std::size_t deaths = 0;
  for (int tick = 0; tick < k_ticks; ++tick) {
    yard.step();
    std::size_t there = 0;
    std::size_t unborn = 0;
    for (std::size_t r = 0; r < world.view().rows(); ++r) {
      there += world.view().presence(Row(r)) == Presence::there;
      unborn += world.view().presence(Row(r)) == Presence::unborn;
    }
    deaths = world.view().rows() - there - unborn;
    EXPECT_EQ(world.view().absent_count(), deaths + unborn);
    EXPECT_EQ(world.lives().unborn(0), unborn);
    EXPECT_EQ(world.view().index().order().size(), there);
    EXPECT_EQ(world.robots(), there);
    for (const std::uint32_t a : world.view().index().order())
      for (const std::uint32_t b : world.view().index().order()) {
        if (world.view().body(Row(a)) >= world.view().body(Row(b))) continue;
        const auto& shape = world.view().type(Row(a)).obstacle;
        ASSERT_FALSE(overlap(shape, world.view().poses()[a], shape, world.view().poses()[b]))
            << "tick " << tick;
      }
  }
  EXPECT_GT(deaths, 10u);
  EXPECT_LT(world.lives().unborn(0), Yard::k_more);
}

TEST(Lives, AResetBringsBackWhoWasThereAtTheStart) {
  Yard yard({.threads = 2});
  std::vector<std::uint64_t> first{yard.world().hashes().state};
  for (int tick = 0; tick < k_ticks; ++tick) {
    yard.step();
    first.push_back(yard.world().hashes().state);
  }
  ASSERT_NE(yard.world().lives().unborn(0), Yard::k_more);
  yard.world().reset();
  EXPECT_EQ(yard.world().lives().unborn(0), Yard::k_more);
  EXPECT_EQ(yard.world().robots(), 30u);
  EXPECT_EQ(yard.world().hashes().state, first[0]);
  for (int tick = 0; tick < k_ticks; ++tick) {
    yard.step();
    ASSERT_EQ(yard.world().hashes().state, first[static_cast<std::size_t>(tick) + 1]) << tick;
  }
}

TEST(Lives, AStateThatCannotHaveComeAboutIsRefused) {
  Plain plain;
  World world = plain.scene.world();
  world.spawn(0, {2, 0, 0, 0});
  std::vector<StateTable> saved(world.tables().begin(), world.tables().end());
  const World::Counters counters = world.counters();
  const auto restored = [&](auto&& change) {
    std::uint64_t hash = 0;
    std::vector<StateTable> tables = saved;
    for (StateTable& table : tables)
      if (table.component() == "life") change(table);
    for (StateTable& table : tables) hash += table.hash_rows(0, table.rows());
    return world.restore(0, counters, hash, [&](std::span<StateTable> into) {
      for (std::size_t t = 0; t < tables.size(); ++t) into[t] = tables[t];
    });
  };
  const auto row_of = [&](std::string_view name) {
    return world.view().row(world.state().names.find(name)).index();
  };
  EXPECT_TRUE(restored([](StateTable&) {}));
  EXPECT_TRUE(world.view().is_there(world.view().row(world.state().names.find("more0"))));
  EXPECT_FALSE(restored([&](StateTable& t) { t.cell<std::uint8_t>(row_of("more1"), 3)[0] = 3; }));
  EXPECT_FALSE(restored([&](StateTable& t) { t.cell<std::uint64_t>(row_of("more0"), 0)[0] = 1; }));
  EXPECT_FALSE(restored([&](StateTable& t) { t.cell<std::uint8_t>(row_of("r"), 3)[0] = 1; }));
  EXPECT_FALSE(restored([&](StateTable& t) { t.cell<std::uint8_t>(row_of("more2"), 3)[0] = 0; }))
      << "before those of lower ids";
}

}  // namespace
}  // namespace troupe::engine::lives_test
