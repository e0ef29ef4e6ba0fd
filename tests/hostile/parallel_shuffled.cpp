// A third backend of the parallel loop (partition/parallel.hpp), for scripts/prove. Each loop runs on new
// threads, runs its tasks in a random order, and sleeps or yields at random before and after them. Orders
// that are rare with a real scheduler thus occur in every tick.
#include "base/fp_environment.hpp"
#include "partition/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <numeric>
#include <random>
#include <thread>
#include <vector>

namespace troupe::partition {

struct Parallel::Workers {
  std::mt19937_64 random{std::random_device{}()};
};

namespace {

void dawdle(std::mt19937_64& random) {
  const std::uint64_t draw = random();
  if (draw % 32 == 0)
    std::this_thread::sleep_for(std::chrono::microseconds(draw / 32 % 100));
  else if (draw % 4 == 0)
    std::this_thread::yield();
}

}  // namespace

Parallel::Parallel(unsigned threads) : threads_(checked(threads)), workers_(std::make_unique<Workers>()) {
  restore_fp_environment();
}

Parallel::~Parallel() = default;
Parallel::Parallel(Parallel&&) noexcept = default;

void Parallel::run_tasks(std::size_t count, Call call, void* task) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::shuffle(order, workers_->random);
  std::atomic<std::size_t> next = 0;
  const auto work = [&](std::uint64_t seed) {
    restore_fp_environment();
    std::mt19937_64 random(seed);
    for (std::size_t i; (i = next.fetch_add(1)) < count;) {
      dawdle(random);
      call(task, order[i]);
      dawdle(random);
    }
  };
  std::vector<std::jthread> threads;
  for (unsigned i = 0; i < std::min<std::size_t>(threads_, count); ++i)
    threads.emplace_back(work, workers_->random());
}

}  // namespace troupe::partition
