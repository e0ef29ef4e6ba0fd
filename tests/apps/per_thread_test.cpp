#include "apps/per_thread.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace troupe::apps::per_thread_test {
namespace {

TEST(PerThread, AThreadThatAsksTwoSetsInTurnHasOneOfEach) {
  PerThread<int> first;
  PerThread<int> second;
  for (int turn = 0; turn < 100; ++turn) {
    ++first.own();
    ++second.own();
  }
  ASSERT_EQ(first.all().size(), 1u);
  EXPECT_EQ(first.all().front(), 100);
  EXPECT_EQ(second.all().size(), 1u);
  std::thread([&] { ++first.own(); }).join();
  EXPECT_EQ(first.all().size(), 2u);
}

}  // namespace
}  // namespace troupe::apps::per_thread_test
