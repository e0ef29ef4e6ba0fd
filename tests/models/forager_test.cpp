#include "models/controllers/forager.hpp"

#include "engine/world/world.hpp"
#include "models/devices/power.hpp"
#include "tests/support/devices.hpp"
#include "tests/support/slow_build.hpp"

#include <gtest/gtest.h>

#include <string>

namespace troupe::models::forager_test {
namespace {

using engine::World;
using test::box;
using test::device;
using test::SceneBuilder;

/// A robot at the origin that is about to charge; a charger 2 m away, and another 6 m away.
struct Pasture {
  static constexpr std::size_t k_scanner = 0, k_pack = 2;
  SceneBuilder scene;
  TypeId charger, robots;
  BodyId robot, near, far;

  Pasture() {
    const engine::Returns unseen{.obstacle = false, .ranger = -1};
    const TypeId depot = scene.type("depot", {box(1, 1, 0.01)}, unseen);
    scene[depot].devices = {device("flags", {})};
    scene.body("red_source", depot, {-6, -6, 0, 0});
    scene.body("red_sink", depot, {-6, 6, 0, 0});
    charger = scene.type("charger", {box(0.3, 0.3, 0.01)}, {.obstacle = false, .ranger = -1, .fiducial = 2});
    scene[charger].devices = {device("power_pack", {{"infinite", true}}),
                              device("power_contact", {{"give", 300.0}})};
    near = scene.body("near", charger, {0, 2, 0, 0});
    far = scene.body("far", charger, {6, 0, 0, 0});
    robots = scene.robot("robot", {box(0.3, 0.24, 0.2)});
    scene[robots].devices = {
        test::ranger("laser", {{.pose = {0.1, 0, 0.15, 0}, .range_max = 4, .fov = k_pi, .samples = 37}}),
        device("flags", {}), device("power_pack", {{"capacity", 3000.0}, {"stored", 500.0}, {"mass", 1.0}}),
        device("power_contact", {{"take", 300.0}})};
    scene[robots].controllers = {test::controller("fasr2", {{"task", std::string("red")}})};
    robot = scene.body("r", robots);
  }
  void add_zone() {
    scene.body("fuel_zone", scene.type("zone", {box(3, 3, 0.01)}, {.obstacle = false, .ranger = -1}),
               {5.5, 0, 0, 0});
  }
  const PowerPackState& pack(const World& world) const {
    return test::state_of<PowerPackState>(world, robot, k_pack);
  }
  static double received(const World& world, BodyId charger) {
    return test::state_of<PowerPackState>(world, charger, 0).given;
  }
  /// Until it has been charged for a second.
  bool charge(World& world) const {
    for (int tick = 0; tick < 1500; ++tick) {
      world.step();
      if (pack(world).received > 300) return true;
    }
    return false;
  }
};

TEST(Fasr2, GoesToTheFuelZoneWhereThereIsOne) {
  if (test::k_slow_build) GTEST_SKIP() << "ways take long to find";
  Pasture plain;
  World without = plain.scene.world();
  ASSERT_TRUE(plain.charge(without));
  EXPECT_GT(Pasture::received(without, plain.near), 0);
  EXPECT_EQ(Pasture::received(without, plain.far), 0);

  Pasture zoned;
  zoned.add_zone();
  World with = zoned.scene.world();
  ASSERT_TRUE(zoned.charge(with));
  EXPECT_EQ(Pasture::received(with, zoned.near), 0);
  EXPECT_GT(Pasture::received(with, zoned.far), 0);
}

TEST(Fasr2, LooksForNoChargerThatIsNotBornYet) {
  if (test::k_slow_build) GTEST_SKIP() << "ways take long to find";
  Pasture pasture;
  pasture.scene.spec.reserves = {{"late", BodyId(pasture.robot.value + 1), 1}};
  pasture.scene.body("late0", pasture.charger, {0, -1, 0, 0});
  World world = pasture.scene.world();
  EXPECT_TRUE(pasture.charge(world));
}

TEST(Fasr2, GoesToThePartThatIsMarked) {
  if (test::k_slow_build) GTEST_SKIP() << "ways take long to find";
  Pasture pasture;
  engine::TypeSpec& charger = pasture.scene[pasture.charger];
  const Pose pose_body_plug{2, 0, 0, 0};
  charger.parts[0].returns.fiducial = 0;
  charger.parts.push_back({.name = "plug",
                           .pose_body_part = pose_body_plug,
                           .solids = charger.parts[0].solids,
                           .returns = {.obstacle = false, .ranger = -1, .fiducial = 2}});
  for (Vec2& vertex : charger.parts[1].solids[0].contours[0]) vertex.x() += pose_body_plug.x;
  for (engine::DeviceSpec& each : charger.devices) {
    each.part = 1;
    each.pose_body_device = pose_body_plug;
  }
  World world = pasture.scene.world();
  ASSERT_TRUE(pasture.charge(world));
  EXPECT_NEAR(world.view().pose(pasture.robot).x, pose_body_plug.x, 0.5);
}

TEST(Fasr2, KeepsItsScannerOnFarFromItsCharger) {
  if (test::k_slow_build) GTEST_SKIP() << "ways take long to find";
  Pasture pasture;
  engine::DeviceSpec finder = device("fiducial", {{"range_max", 3.0}});
  finder.pose_body_device.z = 0.005;  // chargers are flat
  finder.period_s = 0.5;
  pasture.scene[pasture.robots].devices.push_back(finder);
  World world = pasture.scene.world();
  const Row row = world.view().row(pasture.robot);
  const engine::BodyType::Device& scanner = world.view().type(row).devices[Pasture::k_scanner];
  for (int tick = 0; tick < 600 && (world.view().is_on(row, scanner) || world.tick() % 5 != 0); ++tick)
    world.step();
  ASSERT_FALSE(world.view().is_on(row, scanner)) << "it docks";
  const World::Placed far_away{row, {-4, -4, 0, 0}};
  world.set_poses({&far_away, 1});
  world.step();  // the finder does not run in this tick: its reading is that of the charger
  EXPECT_TRUE(world.view().is_on(row, scanner));
}

TEST(Fasr2, SwitchesItsScannerOffWhileItCharges) {
  if (test::k_slow_build) GTEST_SKIP() << "ways take long to find";
  const Pasture pasture;
  World world = pasture.scene.world();
  ASSERT_TRUE(pasture.charge(world));
  const Row row = world.view().row(pasture.robot);
  const engine::BodyType::Device& scanner = world.view().type(row).devices[Pasture::k_scanner];
  for (int tick = 0; world.view().is_on(row, scanner) && tick < 100; ++tick)
    world.step();  // it may creep on a little
  ASSERT_FALSE(world.view().is_on(row, scanner));
  world.step();
  const std::uint64_t beams = world.counters().beams;
  world.step();
  EXPECT_EQ(world.counters().beams, beams);
  for (int tick = 0; tick < 300 && !world.view().is_on(row, scanner); ++tick) world.step();
  EXPECT_TRUE(world.view().is_on(row, scanner)) << "full";
  world.step();
  world.step();
  EXPECT_EQ(world.counters().beams % 37, 0u);
  EXPECT_GT(world.counters().beams, beams);
}

}  // namespace
}  // namespace troupe::models::forager_test
