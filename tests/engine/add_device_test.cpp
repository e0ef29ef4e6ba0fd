#include "engine/spec/add_device.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace troupe::engine::add_device_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(AddDevice, JointsHaveUniqueNames) {
  DeviceKind kind{.name = "hand", .text = ""};
  kind.joints = {"left"};
  TypeSpec type;
  for (const char* name : {"", "grip", "", "grip"}) add_device(type, {.name = name, .kind = "hand"}, kind);
  kind.joints = {"left", "right"};
  add_device(type, {.name = "grip", .kind = "hand"}, kind);
  std::vector<std::string> names;
  for (const JointSpec& joint : type.joints) names.push_back(joint.name);
  EXPECT_THAT(names, ElementsAre("hand", "grip", "hand#2", "grip#2", "grip/left", "grip/right"));
}

// If each name were compared with those of all joints, this test would run for minutes.
TEST(AddDevice, ManyJoints) {
  constexpr std::size_t k_devices = 300000;
  DeviceKind kind{.name = "lift", .text = ""};
  kind.joints = {"lift"};
  TypeSpec type;
  UniqueNames joint_names(k_device_mark);
  for (std::size_t i = 0; i < k_devices; ++i)
    add_device(type, {.name = "lift" + std::to_string(i), .kind = "lift"}, kind, joint_names);
  add_device(type, {.name = "lift7", .kind = "lift"}, kind, joint_names);
  EXPECT_EQ(type.joints.size(), k_devices + 1);
  EXPECT_EQ(type.joints.back().name, "lift7#2");
}

TEST(AddDeviceBody, RefusesSolidsOnJointsThatTheKindDoesNotHave) {
  DeviceKind kind{.name = "hand", .text = ""};
  kind.joints = {"left", "right"};
  kind.body = [](const Record&) { return std::vector<DeviceKind::Fixture>{{{}, -1}, {{}, 1}}; };
  TypeSpec type;
  type.parts.resize(1);
  const std::size_t d = add_device(type, {.name = "grip", .kind = "hand"}, kind);
  add_device_body(type, d, kind);
  ASSERT_EQ(type.parts.size(), 2u);
  EXPECT_EQ(type.parts[0].solids.size(), 1u);
  EXPECT_EQ(type.parts[1].solids.size(), 1u);
  kind.body = [](const Record&) { return std::vector<DeviceKind::Fixture>{{{}, -1}, {{}, 2}}; };
  EXPECT_THAT([&] { add_device_body(type, d, kind); },
              ThrowsMessage<std::runtime_error>(HasSubstr("has a solid on the joint 2")));
  EXPECT_EQ(type.parts.size(), 2u);
  EXPECT_EQ(type.parts[0].solids.size(), 1u);
}

}  // namespace
}  // namespace troupe::engine::add_device_test
