#include "models/devices/light.hpp"

#include "engine/world/world.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace troupe::models::light_test {
namespace {

using test::box;
using test::SceneBuilder;

engine::DeviceSpec light(double period_s, double dutycycle, bool enabled) {
  return {.name = "lamp", .kind = "blinkenlight", .params = {period_s, dutycycle, enabled, 1.0}, .where = {}};
}

/// Whether the light was lit in each of the first ticks, of 0.1 s.
std::vector<int> lit(engine::World& world, std::size_t ticks) {
  std::vector<int> out;
  for (std::size_t t = 0; t < ticks; ++t) {
    world.step();
    const Row row = world.view().row(BodyId(1));
    out.push_back(world.tables()[world.view().type(row).devices.front().table]
                      .as<LightState>(world.view().slot(row))
                      .lit);
  }
  return out;
}

engine::World world_of(const engine::DeviceSpec& device, const std::vector<engine::ControllerSpec>& ctrl = {},
                       const engine::Registry& registry = test::registry()) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.4, 0.4)});
  scene[type].devices = {device};
  scene[type].controllers = ctrl;
  scene.body("r", type, {});
  Diagnostics diagnostics;
  return {scene.spec, registry, {.threads = 1}, diagnostics};
}

TEST(Light, BlinksByPeriodAndDutycycle) {
  engine::World quarter = world_of(light(0.8, 0.5, true));
  EXPECT_EQ(lit(quarter, 9), (std::vector{1, 1, 1, 0, 0, 0, 0, 1, 1}));
  engine::World always = world_of(light(0, 1, true));
  EXPECT_EQ(lit(always, 3), (std::vector{1, 1, 1}));
  engine::World never = world_of(light(0.8, 1, false));
  EXPECT_EQ(lit(never, 3), (std::vector{0, 0, 0}));
}

TEST(Light, RoundingShiftsNoFlash) {
  constexpr std::size_t ticks = 3000;
  engine::World half = world_of(light(0.2, 0.5, true));
  engine::World third = world_of(light(0.3, 1.0 / 3, true));
  engine::World dark = world_of(light(0.7, 0, true));
  engine::World lasting = world_of(light(0.7, 1, true));
  const std::vector<int> halves = lit(half, ticks);
  const std::vector<int> thirds = lit(third, ticks);
  for (std::size_t t = 0; t < ticks; ++t) {
    ASSERT_EQ(halves[t], (t + 1) % 2 == 0) << "tick " << t + 1;
    ASSERT_EQ(thirds[t], (t + 1) % 3 == 0) << "tick " << t + 1;
  }
  EXPECT_EQ(lit(dark, ticks), std::vector(ticks, 0));
  EXPECT_EQ(lit(lasting, ticks), std::vector(ticks, 1));
}

/// Switches the light on at tick 2 and leaves it to itself from tick 5 on.
struct Switcher {
  std::vector<std::size_t> choose(std::span<const engine::DeviceInfo>, std::vector<bool>&) { return {0}; }
  void operator()(const engine::Percept& percept, Random&, engine::Actions& actions) const {
    seen_lit = percept.devices[0].as<LightState>().lit;
    auto& command = actions.device<LightCommand>(0);
    if (percept.tick == 2) command.state = LightCommand::on;
    if (percept.tick == 5) command.state = LightCommand::as_world_says;
  }
  static inline int seen_lit = -1;
};

TEST(Light, IsSwitchedByControllersATickLater) {
  engine::Registry registry = test::registry();
  registry.controllers.push_back(engine::make_controller_kind<Switcher>("switcher", ""));
  engine::World world = world_of({.name = "lamp", .kind = "lightindicator", .params = {1.0}, .where = {}},
                                 {{.kind = "switcher", .params = {}, .where = {}}}, registry);
  EXPECT_EQ(lit(world, 7), (std::vector{0, 0, 1, 1, 1, 0, 0}));
  EXPECT_EQ(Switcher::seen_lit, 0);
}

TEST(Light, MustBeWithinTheRadiusOfItsBody) {
  engine::DeviceSpec lamp = light(0, 1, true);
  const double radius = std::hypot(0.2, 0.2);
  lamp.pose_body_device = {radius * std::cos(0.3), radius * std::sin(0.3), 1, 0};
  EXPECT_NO_THROW(world_of(lamp));
  lamp.pose_body_device = {0.2, 0.21, 0, 0};
  EXPECT_THAT(test::message_of<InputError>([&] { world_of(lamp); }),
              ::testing::HasSubstr(
                  "device \"lamp\" is 0.29 m from the origin of its body; it must be within 0.282843 m, "
                  "the radius of the body"));
}

TEST(Light, IsStateThatIsHashed) {
  engine::World dark = world_of(light(0, 1, false));
  engine::World bright = world_of(light(0, 1, true));
  EXPECT_EQ(dark.hashes().state, bright.hashes().state);
  dark.step();
  bright.step();
  EXPECT_NE(dark.hashes().state, bright.hashes().state);
}

}  // namespace
}  // namespace troupe::models::light_test
