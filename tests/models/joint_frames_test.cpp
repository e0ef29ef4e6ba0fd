// Devices and parts on a joint sense, show and collide as if they had been mounted at the place to which the
// joint has moved them.

#include "engine/kinds/sensor_params.hpp"
#include "models/devices/power.hpp"
#include "tests/support/devices.hpp"
#include "tests/support/slow_build.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace troupe::models::joint_frames_test {
namespace {

using engine::BodyType;
using engine::DeviceSpec;
using engine::Element;
using engine::StateField;
using engine::StateTable;
using engine::Value;
using engine::World;
using test::box;
using test::SceneBuilder;

using Values = std::initializer_list<std::pair<std::string_view, Value>>;

/// An actuator that starts where it stands, and that displacement as a pose in its own frame.
struct Displacement {
  std::string name;
  std::string type;
  std::vector<double> axis;
  double position = 0;
  Pose pose;
};

const std::vector<Displacement>& displacements() {
  static const std::vector<Displacement> all{
      {"along", "linear", {3, 4, 0}, 0.5, {0.3, 0.4, 0, 0}},
      {"up", "linear", {0, 0, 1}, 0.25, {0, 0, 0.25, 0}},
      {"about", "rotational", {0, 0, 0}, 0.7, {0, 0, 0, 0.7}},
  };
  return all;
}

constexpr Pose k_base{0.05, 0.02, 0.1, 0.3};  // of the actuator, body frame

std::size_t add_displaced(engine::TypeSpec& type, const Displacement& by) {
  return test::add_device(
      type, "arm", "actuator", k_base,
      {{"type", by.type}, {"axis", by.axis}, {"max_position", 10.0}, {"start_position", by.position}});
}

DeviceSpec device(const std::string& kind, const Pose& pose, Values values) {
  return {.name = kind,
          .kind = kind,
          .params = test::record(test::registry().device(kind)->params, values),
          .pose_body_device = pose};
}

/// One of every kind of sensor, all with their origin at one pose.
std::vector<DeviceSpec> all_sensors(const Pose& pose) {
  DeviceSpec fan = test::ranger("fan", {{.range_max = 4, .fov = 2, .samples = 31}}, true);
  DeviceSpec cone = test::ranger("cone", {});
  cone.params = engine::to_record(
      engine::RangerParams{.transducers = {{.range_max = 4, .samples = 1, .beam_width = 0.3}}});
  for (DeviceSpec* ranger : {&fan, &cone}) ranger->pose_body_device = pose;
  DeviceSpec bumper = device("bumper", pose, {});
  bumper.params = engine::to_record(
      engine::BumperParams{.bumpers = {{{0.2, 0, 0, 0}, 0.5}, {{0, 0.2, 0, 1.5}, 0.5}}, .thickness = 0.3});
  return {fan,
          cone,
          device("fiducial", pose, {{"range_max", 4.0}, {"fov", 4.0}}),
          device("blobfinder", pose, {{"fov", 2.0}, {"range", 4.0}}),
          bumper,
          device("camera", pose, {{"width", 24}, {"height", 16}, {"range_far", 5.0}})};
}

/// Posts of several heights and colours about the origin.
void add_posts(SceneBuilder& scene) {
  constexpr struct {
    double x, y, heading, height;
    Color color;
  } k_posts[] = {{1.1, 0.2, 0.1, 1.0, {0, 0, 1, 1}},
                 {0.9, 1.2, 0.5, 0.32, {0, 1, 0, 1}},
                 {1.7, -0.9, 0.2, 0.55, {1, 1, 0, 1}},
                 {-0.8, 0.7, 1.0, 1.0, {0, 1, 1, 1}}};
  for (const auto& post : k_posts) {
    const auto n = static_cast<std::int32_t>(scene.spec.bodies.size());
    const std::string name = std::string("post").append(std::to_string(n));
    scene.body(name, scene.type(name, {box(0.3, 0.2, post.height)}, {.fiducial = n}),
               {post.x, post.y, 0, post.heading});
    scene.spec.bodies.back().color = post.color;
  }
}

template <class T>
void expect_equal(const StateTable& a, std::size_t slot_a, const StateTable& b, std::size_t slot_b,
                  std::size_t field, const std::string& where, double tolerance) {
  const auto of_a = a.cell<T>(slot_a, field);
  const auto of_b = b.cell<T>(slot_b, field);
  for (std::size_t i = 0; i < of_a.size(); ++i)
    EXPECT_NEAR(static_cast<double>(of_a[i]), static_cast<double>(of_b[i]), tolerance) << where << i;
}

/// What every sensor of the one body reads, the sensor of the same name of the other does.
void expect_same_readings(const World& a, BodyId in_a, const World& b, BodyId in_b,
                          const std::string& about) {
  const Row row_a = a.view().row(in_a);
  const Row row_b = b.view().row(in_b);
  for (const BodyType::Device& device : b.view().type(row_b).devices) {
    if (!device.kind->is_sensor()) continue;
    const auto& others = a.view().type(row_a).devices;
    const auto other = std::ranges::find(others, device.name, &BodyType::Device::name);
    ASSERT_NE(other, others.end());
    const StateTable& table_a = a.tables()[other->table];
    const StateTable& table_b = b.tables()[device.table];
    for (std::size_t f = 0; f < table_b.fields().size(); ++f) {
      const StateField& field = table_b.fields()[f];
      const std::string where = about + ", " + device.name + " " + field.name + " ";
      const std::size_t slot_a = a.view().slot(row_a);
      const std::size_t slot_b = b.view().slot(row_b);
      switch (field.element) {
        case Element::f64: expect_equal<double>(table_a, slot_a, table_b, slot_b, f, where, 1e-9); break;
        case Element::f32: expect_equal<float>(table_a, slot_a, table_b, slot_b, f, where, 1e-5); break;
        case Element::i32: expect_equal<std::int32_t>(table_a, slot_a, table_b, slot_b, f, where, 0); break;
        case Element::u32: expect_equal<std::uint32_t>(table_a, slot_a, table_b, slot_b, f, where, 0); break;
        case Element::u8: expect_equal<std::uint8_t>(table_a, slot_a, table_b, slot_b, f, where, 0); break;
        default: ADD_FAILURE() << where << "is of another element";
      }
    }
  }
}

class JointFrames : public ::testing::TestWithParam<Displacement> {};
INSTANTIATE_TEST_SUITE_P(By, JointFrames, ::testing::ValuesIn(displacements()),
                         [](const auto& by) { return by.param.name; });

TEST_P(JointFrames, SensorsLookFromWhereTheirJointIs) {
  const Displacement& by = GetParam();
  const Pose on_arm{0.03, 0.01, 0.12, 0.2};
  // Of a body that is nothing but a plate below all sensors, which is in the way of none.
  const auto world_of = [&](bool jointed) {
    SceneBuilder scene;
    const TypeId type = scene.robot("robot", {box(0.1, 0.1, 0.05)});
    std::int32_t joint = engine::k_rigid;
    Pose pose = compose(compose(k_base, by.pose), on_arm);
    if (jointed) {
      joint = scene[type].devices[add_displaced(scene[type], by)].moves;
      pose = compose(k_base, on_arm);
    }
    for (DeviceSpec& sensor : all_sensors(pose)) {
      sensor.joint = joint;
      scene[type].devices.push_back(std::move(sensor));
    }
    scene.body("r", type, {0.1, -0.1, 0, 0.15});
    add_posts(scene);
    return scene.world();
  };
  World jointed = world_of(true);
  World built_there = world_of(false);
  jointed.step();
  built_there.step();
  expect_same_readings(jointed, BodyId(1), built_there, BodyId(1), by.name);
}

TEST_P(JointFrames, WhatAJointCarriesIsSeenAndFeltWhereItIs) {
  const Displacement& by = GetParam();
  const auto scene_of = [&](bool jointed) {
    SceneBuilder scene;
    const TypeId thing = scene.type("thing", {box(0.1, 0.1, 0.1)});
    const auto add_part = [&](double y, const engine::Returns& returns, const Color& color,
                              std::int32_t joint) {
      const Pose rest = compose(k_base, {0, y, 0, 0});
      const Pose there = jointed ? rest : compose(compose(k_base, by.pose), {0, y, 0, 0});
      engine::PartSpec part{.name = std::string("p").append(std::to_string(scene[thing].parts.size())),
                            .kind = "model"};
      part.joint = joint;
      part.pose_body_part = there;
      part.solids = {placed(box(0.2, 0.3, 0.35), there)};
      part.returns = returns;
      part.color = color;
      scene[thing].parts.push_back(std::move(part));
    };
    std::int32_t joint = engine::k_rigid;
    if (jointed) joint = scene[thing].devices[add_displaced(scene[thing], by)].moves;
    add_part(-0.2, {.fiducial = 7}, {0, 0, 1, 1}, joint);
    add_part(0.25, {.ranger = -1, .fiducial = 8}, {0, 1, 0, 1}, joint);              // which rangers pass
    if (!jointed) scene[thing].devices.push_back(device("lightindicator", {}, {}));  // so that it has a row
    scene.body("t", thing, {1.0, 0.1, 0, 0.4});
    const TypeId robot = scene.robot("robot", {box(0.1, 0.1, 0.2)});
    scene[robot].devices = all_sensors({0, 0, 0.26, 0});
    scene[robot].controllers = {test::controller("script", {{"law", "line"}})};
    scene.body("r", robot, {-0.3, 0, 0, 0.1});
    return scene;
  };
  for (const auto ranging : {engine::RangingEngine::exact, engine::RangingEngine::grid}) {
    SceneBuilder scenes[] = {scene_of(true), scene_of(false)};
    for (SceneBuilder& scene : scenes) scene.spec.ranging = ranging;
    World jointed = scenes[0].world();
    World built_there = scenes[1].world();
    for (int t = 0; t < 40; ++t) {
      jointed.step();
      built_there.step();
      const std::string about = by.name + ", tick " + std::to_string(t);
      expect_same_readings(jointed, BodyId(2), built_there, BodyId(2), about);
      EXPECT_NEAR(jointed.view().pose(BodyId(2)).x, built_there.view().pose(BodyId(2)).x, 1e-12) << about;
    }
    EXPECT_TRUE(jointed.view().stalled(jointed.view().row(BodyId(2)))) << "it drove against it";
  }
}

/// A charger whose plate reaches its taker only where its joint has carried it.
TEST(JointFrames, ContactsTouchWhereTheirJointIs) {
  for (const double position : {0.0, 0.5}) {
    SceneBuilder scene;
    const TypeId charger = scene.type("charger", {box(0.1, 0.1, 0.1)});
    const std::size_t arm = test::add_arm(scene[charger], "arm", {0.2, 0, 0, 0}, {box(0.1, 0.1, 0.1)},
                                          {{"start_position", position}});
    scene[charger].devices.push_back(device("power_pack", {}, {{"infinite", true}}));
    DeviceSpec contact = device("power_contact", {}, {{"give", 5.0}});
    contact.part = 1;
    contact.joint = scene[charger].devices[arm].moves;
    scene[charger].devices.push_back(contact);
    scene.body("c", charger);
    const TypeId robot = scene.robot("robot", {box(0.2, 0.2, 0.2)});
    scene[robot].devices = {device("power_pack", {}, {{"capacity", 100.0}, {"stored", 10.0}, {"idle", 0.0}}),
                            device("power_contact", {}, {{"take", 3.0}})};
    const BodyId taker = scene.body("r", robot, {0.86, 0, 0, 0});  // 0.01 m from the plate at 0.7 m
    World world = scene.world();
    for (int t = 0; t < 10; ++t) world.step();
    EXPECT_NEAR(test::state_of<PowerPackState>(world, taker, 0).stored, position > 0 ? 13 : 10, 1e-12);
  }
}

}  // namespace
}  // namespace troupe::models::joint_frames_test
