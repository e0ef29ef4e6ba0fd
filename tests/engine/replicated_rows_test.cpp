#include "engine/ranks/replicated_rows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace troupe::engine::replicated_rows_test {
namespace {

using ::testing::ElementsAre;
using Times = std::vector<std::uint64_t>;

TEST(BalancedCut, GivesAllRanksTheSameTime) {
  // The rows of rank 0 take three times as long as those of rank 1.
  EXPECT_THAT(balanced_cut({0, 100, 200}, Times{300, 100}), ElementsAre(0, 67, 200));
  EXPECT_THAT(balanced_cut({0, 100, 200, 300}, Times{10, 10, 40}), ElementsAre(0, 200, 250, 300));
}

TEST(BalancedCut, StaysIfTheTimesAreEqual) {
  EXPECT_THAT(balanced_cut({0, 10, 20, 30}, Times{7, 7, 7}), ElementsAre(0, 10, 20, 30));
}

TEST(BalancedCut, AllowsRanksWithoutRows) {
  EXPECT_THAT(balanced_cut({0, 0, 100, 100}, Times{5, 90, 5}), ElementsAre(0, 33, 67, 100));
  EXPECT_THAT(balanced_cut({0, 0, 0}, Times{3, 4}), ElementsAre(0, 0, 0));
  EXPECT_THAT(balanced_cut({0, 1, 2, 2, 2}, Times{1, 1, 0, 0}), ElementsAre(0, 1, 1, 2, 2));
}

TEST(BalancedCut, StaysWithoutTimes) {
  EXPECT_THAT(balanced_cut({0, 10, 30}, Times{0, 0}), ElementsAre(0, 10, 30));
}

}  // namespace
}  // namespace troupe::engine::replicated_rows_test
