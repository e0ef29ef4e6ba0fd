#include "engine/kinds/effects.hpp"

#include "engine/kinds/controller.hpp"
#include "engine/kinds/step_error.hpp"
#include "engine/links/effect_views.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace troupe::engine::effects_test {
namespace {

using test::box;
using test::SceneBuilder;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(Effects, ComeBySourceDeviceAndSequence) {
  Effects effects;
  effects.reserve(4);
  effects.emit({.source = BodyId(2), .device = 0, .sequence = 1, .verb = 21});
  effects.emit({.source = BodyId(1), .device = 1, .sequence = 0, .verb = 10});
  effects.emit({.source = BodyId(2), .device = 0, .sequence = 0, .verb = 20});
  effects.emit({.source = BodyId(1), .device = 0, .sequence = 5, .verb = 5});
  std::vector<std::uint32_t> verbs;
  for (const Effect& effect : effects.sorted()) verbs.push_back(effect.verb);
  EXPECT_THAT(verbs, ElementsAre(5, 10, 20, 21));
  EXPECT_THROW(effects.emit({}), std::length_error) << "more than was declared";
  effects.clear();
  EXPECT_TRUE(effects.empty());
  EXPECT_NO_THROW(effects.emit({}));
}

/// After one tick, every holder requests body 1. The holder whose effect is applied first gets it.
struct Holder {
  struct State {
    std::uint32_t holder = 0;  ///< id of the body that has this body
    std::uint32_t reached = 0;
    TROUPE_FIELDS(holder, reached)
  };

  static DeviceKind kind() {
    DeviceKind kind{.name = "holder", .text = ""};
    kind.prepare = [](const Record&, const Pose&) {
      return DeviceKind::Prepared{
          .data = 0, .percepts = memory_fields<State>(), .percept_bytes = sizeof(State), .most_effects = 1};
    };
    kind.act = [](const DeviceBatch& batch) {
      for (std::size_t i = 0; i < batch.rows.size(); ++i) {
        ++batch.state.as<State>(batch.slot(i)).reached;
        batch.emit(i, 0, 0, BodyId(1));
      }
      if (throws) throw std::runtime_error("dropped");
    };
    kind.apply = [](const EffectContext& context, const std::any&, const Effect& effect) {
      const DeviceExchange bodies(context);
      StateTable& states = bodies.table_of(bodies.target_type().devices.front());
      State& target = states.as<State>(bodies.target_slot());
      if (target.holder == 0) target.holder = effect.source.value;
    };
    return kind;
  }
  static const State& state(const World& world, BodyId body) {
    const Row row = world.view().row(body);
    return world.tables()[world.view().type(row).devices.front().table].as<State>(world.view().slot(row));
  }
  static inline bool throws = false;
};

TEST(Effects, TheFirstOfManyHasItOnAnyNumberOfThreads) {
  Registry registry = test::registry();
  registry.devices.push_back(Holder::kind());
  for (const unsigned threads : {1u, 2u, 8u}) {
    SceneBuilder scene;
    const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
    scene[type].devices = {{.name = "hand", .kind = "holder", .params = {}, .where = {}}};
    for (int i = 0; i < 700; ++i) scene.body(std::to_string(i), type, {(i * 37 % 700) * 1.0, 0, 0, 0});
    Diagnostics diagnostics;
    World world(scene.spec, registry, {.threads = threads}, diagnostics);
    world.step();
    EXPECT_EQ(Holder::state(world, BodyId(1)).holder, 1u);
    EXPECT_EQ(Holder::state(world, BodyId(700)).reached, 1u);
    EXPECT_EQ(Holder::state(world, BodyId(700)).holder, 0u);
  }
}

TEST(Effects, OfAStepThatThrewAreForgotten) {
  Registry registry = test::registry();
  registry.devices.push_back(Holder::kind());
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  scene[type].devices = {{.name = "hand", .kind = "holder", .params = {}, .where = {}}};
  for (int i = 0; i < 3; ++i) scene.body(std::to_string(i), type, {i * 1.0, 0, 0, 0});
  Diagnostics diagnostics;
  World world(scene.spec, registry, {.threads = 1}, diagnostics);
  world.step();
  const std::uint64_t after_one = world.hashes().state;
  Holder::throws = true;
  EXPECT_THROW(world.step(), std::runtime_error);
  Holder::throws = false;
  world.reset();
  EXPECT_EQ(Holder::state(world, BodyId(1)).holder, 0u);
  world.step();
  EXPECT_EQ(world.hashes().state, after_one);
}

/// A device that calls `emits` for each robot.
struct Emitter {
  static inline void (*emits)(const DeviceBatch& batch, std::size_t i) = nullptr;

  static DeviceKind kind() {
    DeviceKind kind{.name = "emitter", .text = ""};
    kind.prepare = [](const Record&, const Pose&) {
      return DeviceKind::Prepared{.data = 0, .most_effects = 2};
    };
    kind.act = emit_all;
    kind.apply = [](const EffectContext&, const std::any&, const Effect&) {};
    return kind;
  }
  static void emit_all(const DeviceBatch& batch) {
    for (std::size_t i = 0; i < batch.rows.size(); ++i) emits(batch, i);
  }
};

/// Returns the error of the first step of three robots with these devices.
std::string error_of(std::vector<DeviceKind> kinds) {
  Registry registry = test::registry();
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  for (const DeviceKind& kind : kinds) {
    scene[type].devices.push_back({.name = std::string(kind.name),
                                   .kind = std::string(kind.name),
                                   .params = {},
                                   .active = true,
                                   .where = {}});
    registry.devices.push_back(kind);
  }
  for (int i = 0; i < 3; ++i) scene.body(std::to_string(i), type, {i * 1.0, 0, 0, 0});
  Diagnostics diagnostics;
  World world(scene.spec, registry, {.threads = 1}, diagnostics);
  try {
    world.step();
  } catch (const StepError& error) {
    return error.what();
  }
  return {};
}

TEST(Effects, OfAllBodiesTakeALimitedAmountOfMemory) {
  DeviceKind many = Emitter::kind();
  many.prepare = [](const Record&, const Pose&) {
    return DeviceKind::Prepared{.data = 0, .most_effects = 1'000'000};
  };
  Registry registry = test::registry();
  registry.devices.push_back(many);
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  scene[type].devices = {{.name = "d", .kind = "emitter", .params = {}, .where = {}}};
  for (int i = 0; i < 300; ++i) scene.body(std::to_string(i), type, {i * 1.0, 0, 0, 0});
  Diagnostics diagnostics;
  EXPECT_THAT(test::message_of<InputError>([&] { World(scene.spec, registry, {.threads = 1}, diagnostics); }),
              HasSubstr("outlines and effects of all bodies take more than 16 GB"));
}

TEST(DeviceReach, MayBeInfinite) {
  Registry registry = test::registry();
  DeviceKind eye{.name = "eye", .text = ""};
  eye.prepare = [](const Record&, const Pose&) {
    return DeviceKind::Prepared{.data = 0, .reach_m = std::numeric_limits<double>::infinity()};
  };
  eye.sense = [](const SenseBatch&) -> std::uint64_t { return 0; };
  registry.devices.push_back(eye);
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  scene[type].devices = {{.name = "eye", .kind = "eye", .params = {}, .active = true, .where = {}}};
  for (int i = 0; i < 3; ++i) scene.body(std::to_string(i), type, {i * 1.0, 0, 0, 0});
  Diagnostics diagnostics;
  World world(scene.spec, registry, {.threads = 1}, diagnostics);
  std::size_t near = 0;
  world.view().index().for_each_near(Box::around({0, 0}, 5), [&](const partition::BodyCircle&) { ++near; });
  EXPECT_EQ(near, 3u);
}

TEST(Commands, InAnUnknownModeEndTheStep) {
  SceneBuilder scene;
  scene.body("r", scene.robot("robot", {box(0.4, 0.4)}), {0, 0, 0, 0});
  World world = scene.world();
  world.set_command(Row(0), {1, 0, 0, static_cast<ControlMode>(77)});
  EXPECT_EQ(test::message_of<StepError>([&] { world.step(); }),
            "tick 1: robot \"r\" was commanded in a mode that is no value of ControlMode");
}

TEST(Joints, ThatTheKindDoesNotDeclareEndTheStep) {
  Emitter::emits = [](const DeviceBatch& batch, std::size_t i) { batch.move_joint(i, 0, Pose{}); };
  EXPECT_EQ(
      error_of({Emitter::kind()}),
      "tick 1: device \"emitter\" (emitter) of \"0\" uses its joint with the index 0 (counted from 0), but "
      "its kind has 0 joints (DeviceKind::joints)");
  Emitter::emits = [](const DeviceBatch& batch, std::size_t i) { batch.joint(i, 2); };
  EXPECT_THAT(error_of({Emitter::kind()}), HasSubstr("uses its joint with the index 2"));
}

// The row after those of a batch is that of a body for which another thread calls the hook.
TEST(DeviceBatch, RefusesRowsAndDevicesThatItDoesNotHave) {
  const std::string threw =
      "tick 1: device \"emitter\" (emitter) of \"0\", the first of a batch of 3 robots, threw: ";
  Emitter::emits = [](const DeviceBatch& batch, std::size_t i) { static_cast<void>(batch.slot(i + 1)); };
  EXPECT_EQ(error_of({Emitter::kind()}),
            threw + "uses the robot with the index 3 (counted from 0) of a batch of 3 robots");
  Emitter::emits = [](const DeviceBatch& batch, std::size_t) { batch.emit(77, 0, 0, BodyId(1)); };
  EXPECT_THAT(error_of({Emitter::kind()}), HasSubstr("uses the robot with the index 77"));
  Emitter::emits = [](const DeviceBatch& batch, std::size_t) { batch.move_joint(3, 0, Pose{}); };
  EXPECT_THAT(error_of({Emitter::kind()}), HasSubstr("uses the robot with the index 3"));
  Emitter::emits = [](const DeviceBatch& batch, std::size_t i) { static_cast<void>(batch.runs(i, 1)); };
  EXPECT_EQ(
      error_of({Emitter::kind()}),
      threw + "uses the device with the index 1 (counted from 0) of its body, which has only 1 devices");
}

TEST(Effects, ThatADeviceMustNotEmitEndTheStep) {
  Emitter::emits = [](const DeviceBatch& batch, std::size_t i) { batch.emit(i, 0, 0, BodyId(1)); };
  EXPECT_EQ(error_of({Emitter::kind()}), "");
  DeviceKind useless = Emitter::kind();
  useless.apply = nullptr;
  EXPECT_EQ(
      error_of({useless}),
      "tick 1: device \"emitter\" (emitter) of \"0\" emitted an effect, but its kind has no hook \"apply\", "
      "which would apply it");

  DeviceKind sensor{.name = "eye", .text = ""};
  sensor.prepare = [](const Record&, const Pose&) { return DeviceKind::Prepared{.data = 0}; };
  sensor.sense = [](const SenseBatch& batch) -> std::uint64_t {
    batch.emit(0, 0, 0, BodyId(1));
    return 0;
  };
  Emitter::emits = [](const DeviceBatch&, std::size_t) {};
  EXPECT_EQ(error_of({Emitter::kind(), sensor}),
            "tick 1: device \"eye\" (eye) of \"0\" emitted an effect, but it is a sensor: only the hook "
            "\"act\" may "
            "emit effects");

  Emitter::emits = [](const DeviceBatch& batch, std::size_t i) { batch.emit(i, 0, 0, BodyId(999)); };
  EXPECT_EQ(
      error_of({Emitter::kind()}),
      "tick 1: device \"emitter\" (emitter) of \"0\" emitted an effect on the body with the id 999, but the "
      "largest id is 3");
  Emitter::emits = [](const DeviceBatch& batch, std::size_t i) { batch.emit_birth(i, 0, 7, {}); };
  EXPECT_EQ(error_of({Emitter::kind()}),
            "tick 1: device \"emitter\" (emitter) of \"0\" requested a birth from the reserve with index 7 "
            "(counted "
            "from 0), but the world has 0 populations with a reserve");
  Emitter::emits = [](const DeviceBatch& batch, std::size_t i) { batch.emit_death(i, 0, BodyId(1)); };
  EXPECT_EQ(error_of({Emitter::kind()}),
            "tick 1: device \"emitter\" (emitter) of \"0\" requested a death, but its kind does not set "
            "DeviceKind::Prepared::ends_lives in prepare()");

  // Two effects with one number have no order.
  Emitter::emits = [](const DeviceBatch& batch, std::size_t i) {
    batch.emit(i, 3, 0, BodyId(1));
    batch.emit(i, 3, 1, BodyId(2));
  };
  EXPECT_EQ(error_of({Emitter::kind()}),
            "tick 1: device \"emitter\" (emitter) of \"0\" emitted two effects with the number 3 "
            "(Effect::sequence): each effect of a device in a tick needs another number");
}

}  // namespace
}  // namespace troupe::engine::effects_test
