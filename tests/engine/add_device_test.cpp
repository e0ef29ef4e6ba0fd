#include "engine/spec/add_device.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace troupe::engine {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

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
}  // namespace troupe::engine
