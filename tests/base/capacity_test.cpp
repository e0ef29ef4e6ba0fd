#include "base/capacity.hpp"

#include <gtest/gtest.h>

#include <barrier>
#include <memory>
#include <thread>
#include <vector>

namespace troupe::capacity_test {
namespace {

TEST(Room, AListThatVariesSlightlyKeepsItsMemory) {
  EXPECT_EQ(capacity_for(100, 0), 100u);
  EXPECT_EQ(capacity_for(100, 100), 100u);
  EXPECT_EQ(capacity_for(100, 150), 150u);
  EXPECT_EQ(capacity_for(100, 158), 158u);
  EXPECT_EQ(capacity_for(100, 159), 103u) << "more than one and a half times the size, and 8 elements";
  EXPECT_EQ(capacity_for(101, 100), 104u);
  EXPECT_EQ(capacity_for(0, 8), 8u);
  EXPECT_EQ(capacity_for(0, 9), 0u);
}

TEST(Room, ElementsAreMoved) {
  std::vector<std::unique_ptr<int>> list;
  for (int i = 0; i < 100; ++i) list.push_back(std::make_unique<int>(i));
  list.resize(3);
  change_capacity(list, 4);
  EXPECT_LT(list.capacity(), 10u);
  ASSERT_EQ(list.size(), 3u);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(*list[static_cast<std::size_t>(i)], i);
}

TEST(Room, ResizingShrinksAndFills) {
  std::vector<int> list(1000, 1);
  resize_with_capacity(list, 2, 5);
  EXPECT_EQ(list, (std::vector{1, 1}));
  EXPECT_LT(list.capacity(), 100u);
  resize_with_capacity(list, 4, 5);
  EXPECT_EQ(list, (std::vector{1, 1, 5, 5}));
}

// In builds with sanitizers, the calls below are the first that reach the allocator of glibc, which must not
// be initialized by two threads at the same time: glibc would abort the process when these threads end.
TEST(Room, ThreadsMayReleaseMemoryAtTheSameTime) {
  constexpr std::size_t k_threads = 8;
  std::barrier together(k_threads);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < k_threads; ++i)
    threads.emplace_back([&] {
      together.arrive_and_wait();
      release_freed_memory();
    });
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace troupe::capacity_test
