#include "base/ids.hpp"

#include <gtest/gtest.h>

#include <concepts>
#include <unordered_map>

namespace troupe::ids_test {
namespace {

static_assert(!std::convertible_to<BodyId, TypeId> && !std::constructible_from<BodyId, TypeId>);
static_assert(!std::convertible_to<int, BodyId> && !std::convertible_to<BodyId, std::uint32_t>);

TEST(Id, IsInvalidUntilGiven) {
  EXPECT_FALSE(BodyId().valid());
  EXPECT_TRUE(BodyId(std::size_t{0}).valid());
  EXPECT_EQ(BodyId(std::size_t{7}).index(), 7u);
}

TEST(Id, OrdersAndHashesByNumber) {
  EXPECT_LT(BodyId(std::size_t{1}), BodyId(std::size_t{2}));
  EXPECT_LT(BodyId(std::size_t{2}), BodyId());
  std::unordered_map<BodyId, int> map;
  map[BodyId(std::size_t{3})] = 5;
  EXPECT_EQ(map.at(BodyId(std::size_t{3})), 5);
}

}  // namespace
}  // namespace troupe::ids_test
