#include "base/split.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace troupe::split_test {
namespace {

using testing::ElementsAre;

TEST(Split, ReturnsThePartsBetweenTheSeparators) {
  EXPECT_THAT(split("pose,ranges", ','), ElementsAre("pose", "ranges"));
  EXPECT_THAT(split("state/joint/arm", '/'), ElementsAre("state", "joint", "arm"));
  EXPECT_THAT(split("a b,c", ' '), ElementsAre("a", "b,c"));
  EXPECT_THAT(split("pose", ','), ElementsAre("pose"));
}

TEST(Split, PartsMayBeEmpty) {
  EXPECT_THAT(split("", ','), ElementsAre(""));
  EXPECT_THAT(split(",", ','), ElementsAre("", ""));
  EXPECT_THAT(split("a,,b", ','), ElementsAre("a", "", "b"));
  EXPECT_THAT(split(",a,", ','), ElementsAre("", "a", ""));
}

TEST(Joined, PutsTheSeparatorBetweenTexts) {
  using Texts = std::vector<std::string_view>;
  EXPECT_EQ(joined(Texts(), ", "), "");
  EXPECT_EQ(joined(Texts{"a"}, ", "), "a");
  EXPECT_EQ(joined(Texts{"", "b", ""}, ", "), ", b, ");
}

}  // namespace
}  // namespace troupe::split_test
