#include "engine/world/world.hpp"
#include "models/devices/actuator.hpp"
#include "tests/worldio/json_test_world.hpp"
#include "troupe/registry.hpp"
#include "worldio/results/recording_fields.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

namespace troupe::worldio::json_joints_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const std::string k_gate = R"({
  "troupe": 1,
  "types": {
    "gate": {
      "size_m": [0.1, 0.1, 0.5],
      "sensors": [
        {"name": "eye", "kind": "ranger", "on": "boom", "pose": {"x_m": 0.2}, "transducers": [{"range_max_m": 2}]}
      ],
      "devices": [
        {"name": "boom", "kind": "actuator", "pose": {"x_m": 0.1, "z_m": 0.2, "heading_deg": 90},
         "type": "rotational", "max_position": 1.5, "size_m": [1, 0.04, 0.05], "color": "blue", "ranger_return": 0.25},
        {"name": "lamp", "kind": "lightindicator", "on": "boom"},
        {"name": "hand", "kind": "gripper", "on": "boom", "pose": {"x_m": 1}, "size_m": [0.2, 0.4, 0.1]}
      ],
      "controller": {"kind": "operate", "orders": [{"at_s": 0.2, "device": "boom", "order": "go_to", "value": 1.2}]}
    }
  },
  "models": [{"name": "g", "type": "gate"}]
})";

struct Read {
  Diagnostics diagnostics;
  engine::Registry registry = make_registry();
  engine::WorldSpec spec;
  std::vector<std::string> found;

  explicit Read(const std::string& text) {
    spec = load_json_world("gate.json", text, registry, {}, diagnostics);
    found = findings(diagnostics);
  }
};

std::string changed(const std::string& from, const std::string& to) {
  std::string text = k_gate;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

void expect_box(const Box& box, double x0, double y0, double x1, double y1) {
  EXPECT_NEAR(box.min.x(), x0, 1e-12);
  EXPECT_NEAR(box.min.y(), y0, 1e-12);
  EXPECT_NEAR(box.max.x(), x1, 1e-12);
  EXPECT_NEAR(box.max.y(), y1, 1e-12);
}

TEST(JsonJoints, DevicesMoveTheirBodyAndWhatStandsOnThem) {
  const Read read(k_gate);
  ASSERT_THAT(read.found, IsEmpty());
  const engine::TypeSpec& type = read.spec.types.back();
  ASSERT_THAT(type.joints, SizeIs(3));
  EXPECT_EQ(type.joints[0].name, "boom");
  EXPECT_EQ(type.joints[0].parent, engine::k_rigid);
  EXPECT_EQ(type.joints[1].name, "hand/left");
  EXPECT_EQ(type.joints[1].parent, 0);

  ASSERT_THAT(type.parts, SizeIs(5)) << "the post, the boom, the gripper's base and its paddles";
  const engine::PartSpec& boom = type.parts[1];
  EXPECT_EQ(boom.name, "boom");
  EXPECT_EQ(boom.joint, 0);
  EXPECT_EQ(boom.parent, 0u);
  expect_box(bounds(boom.solids[0].contours[0]), 0.08, -0.5, 0.12, 0.5);
  EXPECT_NEAR(boom.solids[0].z.min, 0.2, 1e-12);
  EXPECT_NEAR(boom.solids[0].z.max, 0.25, 1e-12);
  EXPECT_EQ(boom.color, (Color{0, 0, 1, 1}));
  EXPECT_EQ(boom.returns.ranger, 0.25f);
  const engine::PartSpec& base = type.parts[2];
  EXPECT_EQ(base.joint, 0);
  EXPECT_EQ(base.parent, 1u);
  expect_box(bounds(base.solids[0].contours[0]), -0.1, 0.9, 0.3, 0.968);
  EXPECT_EQ(type.parts[3].joint, 1);
  EXPECT_EQ(type.parts[4].joint, 2);

  ASSERT_THAT(type.devices, SizeIs(4));
  for (const std::size_t d : {0u, 2u}) {  // the eye and the lamp
    EXPECT_EQ(type.devices[d].joint, 0) << d;
    EXPECT_EQ(type.devices[d].part, 1u) << d;
  }
  EXPECT_NEAR(type.devices[0].pose_body_device.x, 0.1, 1e-12);
  EXPECT_NEAR(type.devices[0].pose_body_device.y, 0.2, 1e-12);
  EXPECT_EQ(type.devices[1].joint, engine::k_rigid);
  EXPECT_EQ(type.devices[1].moves, 0);
  EXPECT_EQ(type.devices[3].moves, 1);
}

TEST(JsonJoints, AGateWithoutADriveIsOperated) {
  Read read(k_gate);
  engine::World world(read.spec, read.registry, {}, read.diagnostics);
  ASSERT_THAT(findings(read.diagnostics), IsEmpty());
  for (int t = 0; t < 20; ++t) world.step();
  const Row row = world.view().row(world.state().names.find("g"));
  const auto& state = world.tables()[world.view().type(row).devices[1].table].as<models::ActuatorState>(0);
  EXPECT_NEAR(state.position, 1.2, 1e-12);
  EXPECT_NEAR(world.view().mount(row, 0).heading, 1.2, 1e-12);
}

TEST(JsonJoints, RecordingsKnowTheirFrames) {
  Read read(k_gate);
  const engine::World world(read.spec, read.registry, {}, read.diagnostics);
  std::map<std::string, std::string> frames;
  const std::vector<std::string> all{"all"};
  for (const RecordedComponent& component : recorded_components(world, all))
    frames[component.name] = component.frame;
  EXPECT_EQ(frames["pose"], "world");
  EXPECT_EQ(frames["joint/boom"], "joint");
  EXPECT_EQ(frames["joint/hand/left"], "joint");
  EXPECT_EQ(frames["carrier"], "carrier");
}

TEST(JsonJoints, DevicesAreOrderedAsListed) {
  const auto ordered = [](const std::string& list) {
    return Read(changed(R"("controller":)", R"("device_order": )" + list + R"(, "controller":)"));
  };
  const Read read = ordered(R"(["hand", "eye", "boom", "lamp"])");
  EXPECT_THAT(read.found, IsEmpty());
  std::vector<std::string> names;
  for (const engine::TypeSpec& type : read.spec.types)
    for (const engine::DeviceSpec& device : type.devices) names.push_back(device.name);
  EXPECT_THAT(names, ElementsAre("hand", "eye", "boom", "lamp"));

  const auto error = [](const std::string& what) {
    return ElementsAre("gate.json:15: error: /types/gate/device_order: " + what +
                       ": list every device of the type exactly once");
  };
  EXPECT_THAT(ordered(R"(["hand", "eye", "boom"])").found, error("the device \"lamp\" is missing"));
  EXPECT_THAT(ordered(R"(["hand", "eye", "eye", "lamp"])").found, error("\"eye\" is listed twice"));
  EXPECT_THAT(ordered(R"(["hand", "eye", "beam", "lamp"])").found,
              error("\"beam\" is not a device of the type"));
}

TEST(JsonJoints, DevicesInARingStandOnThoseOfTheirOwnCopy) {
  Read read(R"({"troupe": 1, "types": {"bot": {"size_m": [1, 1, 0.1],
  "devices": [
    {"name": "lift", "kind": "actuator", "type": "linear", "axis": [0, 0, 1], "max_position": 1, "size_m": [0.1, 0.1, 0.1]},
    {"name": "lamp", "kind": "led", "on": "lift", "ring": {"count": 2, "radius_m": 0.2}}],
  "parts": [
    {"name": "arm", "size_m": [0.1, 0.1, 0.1], "joint": "lift", "ring": {"count": 2, "radius_m": 2}, "obstacle": false,
     "devices": [
       {"name": "boom", "kind": "actuator", "type": "rotational", "size_m": [1, 0.04, 0.05]},
       {"name": "hand", "kind": "gripper", "on": "boom", "pose": {"x_m": 1}, "size_m": [0.2, 0.4, 0.1]}],
     "sensors": [{"name": "eye", "kind": "compass", "on": "boom"},
                 {"name": "nail", "kind": "compass", "joint": "hand/left"}],
     "controller": {"kind": "operate", "orders": [{"at_s": 0, "device": "boom", "order": "go_to", "value": 1}]},
     "parts": [{"name": "own", "device": {"name": "turret", "kind": "actuator", "type": "rotational"},
                "size_m": [0.1, 0.1, 0.1]}]}]}},
  "models": [{"name": "b", "type": "bot"}]})");
  ASSERT_THAT(read.found, IsEmpty());
  const engine::TypeSpec& type = read.spec.types.back();
  std::map<std::string, std::string> stands;  // device -> joint
  for (const engine::DeviceSpec& device : type.devices)
    stands[device.name] =
        device.joint == engine::k_rigid ? "" : type.joints[static_cast<std::size_t>(device.joint)].name;
  for (const std::string copy : {"0", "1"}) {
    EXPECT_EQ(stands.at("lamp" + copy), "lift") << "all copies stand on the device outside of the ring";
    EXPECT_EQ(stands.at("eye" + copy), "boom" + copy);
    EXPECT_EQ(stands.at("hand" + copy), "boom" + copy);
    EXPECT_EQ(stands.at("nail" + copy), "hand" + copy + "/left");
    EXPECT_TRUE(stands.contains("turret" + copy));
  }
  engine::World world(read.spec, read.registry, {}, read.diagnostics);
  EXPECT_THAT(findings(read.diagnostics), IsEmpty());
}

TEST(JsonJoints, WhatIsWrongIsTold) {
  EXPECT_THAT(Read(changed(R"("on": "boom"},)", R"("on": "bom"},)")).found,
              ElementsAre("gate.json:12: error: /types/gate/devices/1/on: unknown device with a joint "
                          "\"bom\"; known: boom (did you mean \"boom\"?)"));
  EXPECT_THAT(Read(changed(R"("on": "boom", "pose": {"x_m": 0.2})", R"("on": 3)")).found,
              ElementsAre(::testing::HasSubstr("gate.json:7: error: /types/gate/sensors/0/on: ")));
  EXPECT_THAT(Read(changed(R"("size_m": [1, 0.04, 0.05])", R"("size_m": [1, 0, 0.05])")).found,
              ElementsAre(::testing::HasSubstr("gate.json:11: error: /types/gate/devices/0/size_m")));
  const auto error_of = [](const std::string& text) -> std::string {
    Read read(text);
    try {
      engine::World world(read.spec, read.registry, {}, read.diagnostics);
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_THAT(
      error_of(changed(R"("device": "boom")", R"("device": "barrier")")),
      ::testing::HasSubstr("gate.json:15: error: controller \"operate\" has an order for the unknown device "
                           "\"barrier\"; known: boom, eye, hand, lamp"));
  EXPECT_THAT(error_of(changed(R"("order": "go_to")", R"("order": "close")")),
              ::testing::HasSubstr(
                  "has an order \"close\" for \"boom\", which is of kind \"actuator\": only devices of kind "
                  "\"gripper\" take this order"));
  EXPECT_THAT(
      error_of(changed(R"("device": "boom", "order": "go_to")", R"("device": "hand", "order": "close")")),
      ::testing::HasSubstr(
          "has an order \"close\" for \"hand\" with the value 1.2: this order takes no value"));
}

}  // namespace
}  // namespace troupe::worldio::json_joints_test
