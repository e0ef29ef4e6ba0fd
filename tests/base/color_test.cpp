#include "base/color.hpp"

#include <gtest/gtest.h>

namespace troupe::color_test {
namespace {

TEST(ToByte, RoundsToTheNearestAndHalvesUpwards) {
  for (int byte = 0; byte <= 255; ++byte) EXPECT_EQ(to_byte(static_cast<float>(byte) / 255), byte);
  EXPECT_EQ(to_byte(0.5f), 128);  // 127.5
  EXPECT_EQ(to_byte(0.4999f), 127);
}

TEST(ToByte, ClampsToTheRange) {
  EXPECT_EQ(to_byte(-0.001f), 0);
  EXPECT_EQ(to_byte(-1e30f), 0);
  EXPECT_EQ(to_byte(1.001f), 255);
  EXPECT_EQ(to_byte(1e30f), 255);
}

}  // namespace
}  // namespace troupe::color_test
