#include "apps/ranks/rank_place.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace troupe::apps::rank_place_test {
namespace {

TEST(RankPlace, RanksShareTheSameProcessorsOfOneComputer) {
  const std::vector<RankPlace> places{{"a", "0 1"}, {"a", "2 3"}, {"a", "0 1"}, {"b", "0 1"}, {"b", "2 3"}};
  std::vector<unsigned> sharing;
  for (std::size_t rank = 0; rank < places.size(); ++rank) sharing.push_back(count_sharing(places, rank));
  EXPECT_EQ(sharing, (std::vector<unsigned>{2, 1, 2, 1, 1}));
}

}  // namespace
}  // namespace troupe::apps::rank_place_test
