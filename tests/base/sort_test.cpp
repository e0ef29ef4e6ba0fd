#include "base/sort.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace troupe::sort_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(Sort, SortsIds) {
  std::vector<BodyId> ids{BodyId(3), BodyId(1), BodyId(3), BodyId(2)};
  sort_ids(ids);
  EXPECT_THAT(ids, ElementsAre(BodyId(1), BodyId(2), BodyId(3), BodyId(3)));
  ids = {BodyId(3), BodyId(1), BodyId(3), BodyId(2), BodyId(1)};
  sort_unique(ids);
  EXPECT_THAT(ids, ElementsAre(BodyId(1), BodyId(2), BodyId(3)));
}

TEST(Sort, OrdersIndicesByTheirKeys) {
  const std::vector<std::uint64_t> keys{7, ~std::uint64_t{0}, 0, 7, 5};
  EXPECT_THAT(sorted_order(keys), ElementsAre(2, 4, 0, 3, 1));
  EXPECT_THAT(sorted_order({}), IsEmpty());
  // Many equal keys, so that an unstable sort would change their order.
  const std::vector<std::size_t> order = sorted_order(std::vector<std::uint64_t>(1000, 1));
  for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
}

}  // namespace
}  // namespace troupe::sort_test
