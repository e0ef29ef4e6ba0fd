#include "base/atomic_extremes.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

namespace troupe::atomic_extremes_test {
namespace {

TEST(AtomicMaximum, IsRaisedOnlyByGreaterNumbers) {
  std::atomic<std::uint64_t> most = 0;
  EXPECT_EQ(value_of(most), 0.0);
  for (const double value : {5e-324, 1.0, 1.5, 1e300}) {
    raise_to(most, value);
    EXPECT_EQ(value_of(most), value);
    raise_to(most, 0.5 * value);
    EXPECT_EQ(value_of(most), value);
  }
}

TEST(AtomicMaximum, IsThatOfAllThreads) {
  constexpr int k_threads = 4;
  constexpr int k_numbers = 10'000;
  std::atomic<std::uint64_t> most = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < k_threads; ++t)
    threads.emplace_back([&most, t] {
      for (int i = 0; i < k_numbers; ++i) raise_to(most, (i * 7919) % k_numbers + 0.125 * t);
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(value_of(most), k_numbers - 1 + 0.125 * (k_threads - 1));
}

}  // namespace
}  // namespace troupe::atomic_extremes_test
