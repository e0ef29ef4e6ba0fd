#include "models/drives/wheels.hpp"

#include "engine/world/world.hpp"
#include "tests/support/devices.hpp"
#include "tests/support/message_of.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace troupe::models::wheels_test {
namespace {

using engine::World;
using test::box;
using test::SceneBuilder;

/// Drives ahead at 0.5 m/s and switches the first device that it may use off from tick 4 to tick 6.
struct PartSwitcher {
  static constexpr bool switches = true;

  Result<std::vector<std::size_t>> choose(std::span<const engine::DeviceInfo>, std::vector<bool>&) {
    return std::vector<std::size_t>{0};
  }
  void operator()(const engine::Percept& percept, Random&, engine::Actions& actions) const {
    actions.set_speed(0.5, 0, 0);
    actions.switch_device(0, percept.tick < 4 || percept.tick > 6);
  }
};

/// Commands an acceleration of 0.5 m/s^2 ahead.
struct Pusher {
  Result<std::vector<std::size_t>> choose(std::span<const engine::DeviceInfo>, std::vector<bool>&) {
    return std::vector<std::size_t>{};
  }
  void operator()(const engine::Percept&, Random&, engine::Actions& actions) const {
    actions.accelerate(0.5, 0, 0);
  }
};

/// A post with a turret on it, which has a drive of its own, a ranger that sees 1 m far, and a controller.
struct Turret {
  SceneBuilder scene;
  engine::Registry registry = test::registry();
  BodyId body;

  explicit Turret(const std::string& controller) {
    registry.controllers.push_back(engine::make_controller_kind<PartSwitcher>("switcher", ""));
    registry.controllers.push_back(engine::make_controller_kind<Pusher>("pusher", ""));
    const TypeId type = scene.type("post", {box(0.2, 0.2, 0.5)});
    engine::TypeSpec& spec = scene[type];
    const std::size_t feet = test::add_device(spec, "feet", "wheels", {0, 0, 0.5, 0});
    spec.parts.push_back({.name = "feet",
                          .kind = "position",
                          .joint = spec.devices[feet].moves,
                          .pose_body_part = {0, 0, 0.5, 0}});
    spec.devices[feet].part = 1;
    engine::DeviceSpec eye = test::ranger("eye", {{.range_max = 1}});
    eye.part = 1;
    eye.joint = spec.devices[feet].moves;
    eye.pose_body_device = {0, 0, 0.5, 0};
    spec.devices.push_back(eye);
    spec.controllers = {{.kind = controller, .part = 1, .params = {}, .where = {}}};
    body = scene.body("p", type);
  }
  World world() const {
    Diagnostics diagnostics;
    return {scene.spec, registry, {.threads = 1}, diagnostics};
  }
  float range(const World& world) const {
    const Row row = world.view().row(body);
    return world.tables()[world.view().type(row).devices[1].table].cell<float>(world.view().slot(row), 0)[0];
  }
};

TEST(Wheels, ControllersOfTheirPartSwitchItsDevices) {
  Turret turret("switcher");
  turret.scene.wall(0.9, -1, 1, 1);
  World world = turret.world();
  std::vector<float> ranges;
  for (int tick = 0; tick < 9; ++tick) {
    world.step();
    ranges.push_back(turret.range(world));
  }
  // The command of tick t takes effect in tick t + 1.
  EXPECT_LT(ranges[3], ranges[2]) << "it runs in tick 4";
  EXPECT_EQ(ranges[4], ranges[3]) << "it is off from tick 5";
  EXPECT_EQ(ranges[6], ranges[3]) << "to tick 7";
  EXPECT_LT(ranges[7], ranges[6]) << "and runs again in tick 8";
}

/// A motion that rounding makes no motion is not blocked.
TEST(Wheels, AreNotStalledByASpeedThatIsTooSmallToMoveThem) {
  Turret turret("script");
  const TypeId type = turret.scene.spec.bodies[turret.body.index()].type;
  turret.scene[type].controllers[0].params =
      test::drive_legs({test::leg(1, 0.5), test::leg(9, 1e-18)}).params;
  World world = turret.world();
  for (int tick = 0; tick < 20; ++tick) world.step();
  const auto& wheels = test::state_of<WheelsState>(world, turret.body, 0);
  EXPECT_EQ(wheels.forward, 1e-18);
  EXPECT_EQ(wheels.stalled, 0);
}

TEST(Wheels, ACommandThatIsNotFiniteIsAnError) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Turret turret("switcher");
    World world = turret.world();
    const Row row = world.view().row(turret.body);
    reinterpret_cast<engine::Command*>(world.device_command(row, world.view().type(row).devices[0]))->turn =
        bad;
    EXPECT_EQ(test::message_of<engine::StepError>([&] { world.step(); }),
              "tick 1: a drive on a part of \"p\" was commanded a velocity that is not a finite number");
  }
}

TEST(Wheels, BoundsThatContradictOneAnotherAreAnError) {
  SceneBuilder scene;
  const TypeId type = scene.type("cart", {box(0.2, 0.2)});
  test::add_device(scene[type], "feet", "wheels", {}, {{"velocity_min_x", 1.0}, {"velocity_max_x", -1.0}});
  scene.body("c", type);
  EXPECT_EQ(
      scene.error(),
      "error: device \"feet\" has contradictory drive parameters: velocity_min_x, velocity_max_x: lower "
      "bound 1 exceeds upper bound -1");
}

TEST(Wheels, SensorsOnTheirPartSeeNoFartherThanTheyDeclare) {
  Turret turret("switcher");
  turret.scene.body("r", turret.scene.robot("bot", {box(0.4, 0.4)}), {3, 0, 0, 0});
  World world = turret.world();
  World blinkered = turret.world();
  blinkered.hide_beyond_reach(true);
  for (int tick = 0; tick < 50; ++tick) {
    world.step();
    blinkered.step();
    ASSERT_EQ(world.hashes().state, blinkered.hashes().state) << "tick " << world.tick();
  }
  EXPECT_LT(turret.range(world), 1) << "the sensor has come near the robot";
}

TEST(Wheels, StartFromRestAfterTheirBodyWasDisabled) {
  Turret turret("pusher");
  turret.scene.spec.mortal = true;
  World world = turret.world();
  const auto forward = [&] { return test::state_of<WheelsState>(world, turret.body, 0).forward; };
  for (int tick = 0; tick < 11; ++tick) world.step();
  EXPECT_NEAR(forward(), 0.5, 1e-9);
  world.set_disabled(world.view().row(turret.body), true);
  world.step();
  EXPECT_EQ(forward(), 0);
  world.set_disabled(world.view().row(turret.body), false);
  world.step();
  EXPECT_NEAR(forward(), 0.05, 1e-9) << "one tick of the acceleration";
}

TEST(Wheels, HaveNoVelocityWithoutPower) {
  Turret turret("pusher");
  test::add_device(turret.scene[TypeId(1)], "pack", "power_pack", {}, {{"capacity", 5.0}, {"draw", 10.0}});
  World world = turret.world();
  const auto forward = [&] { return test::state_of<WheelsState>(world, turret.body, 0).forward; };
  for (int tick = 0; tick < 4; ++tick) world.step();
  EXPECT_GT(forward(), 0);
  for (int tick = 0; tick < 4; ++tick) world.step();
  EXPECT_EQ(forward(), 0);
}

}  // namespace
}  // namespace troupe::models::wheels_test
