// A loop whose two tasks write the same number. The thread sanitizer must report it (tests/CMakeLists.txt):
// a sanitizer that does not report it would pass every test.
#include "partition/parallel.hpp"

#include <atomic>
#include <cstdio>
#include <thread>

int main() {
  troupe::partition::Parallel parallel(2);
  int sum = 0;
  // There are many rounds, because the sanitizer may miss two writes that happen at exactly the same time.
  for (int round = 0; round < 100; ++round) {
    std::atomic<int> arrived = 0;
    parallel.for_each(2, [&](std::size_t i) {
      // Both tasks have begun, on two threads, before one of them writes. The order is relaxed, so that the
      // counter does not synchronise the two writes.
      arrived.fetch_add(1, std::memory_order_relaxed);
      while (arrived.load(std::memory_order_relaxed) < 2) std::this_thread::yield();
      sum += static_cast<int>(i);
    });
  }
  std::printf("%d\n", sum);
}
