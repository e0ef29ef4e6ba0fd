#include "partition/parallel.hpp"

#include "base/fp_environment.hpp"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <optional>

namespace troupe::partition {
namespace {

constexpr std::size_t k_most_parts = 64;

}  // namespace

struct Parallel::Workers {
  explicit Workers(unsigned threads) : arena(static_cast<int>(threads)) {
    // By default oneTBB runs at most as many threads as the process had processors when oneTBB started. If an
    // arena asks for more, oneTBB ignores this and prints a warning to standard error. A global_control
    // raises the limit. If there are several global_control objects, the least of their limits applies, so
    // all of them set the same limit, k_most_threads.
    if (threads > static_cast<unsigned>(tbb::info::default_concurrency()))
      limit.emplace(tbb::global_control::max_allowed_parallelism, k_most_threads);
    arena.initialize();
  }

  std::optional<tbb::global_control> limit;
  tbb::task_arena arena;
};

Parallel::Parallel(unsigned threads) : threads_(checked(threads)) {
  restore_fp_environment();
  if (threads_ > 1) workers_ = std::make_unique<Workers>(threads_);
}

Parallel::~Parallel() = default;
Parallel::Parallel(Parallel&&) noexcept = default;
Parallel& Parallel::operator=(Parallel&&) noexcept = default;

void Parallel::run_tasks(std::size_t count, Call call, void* task) {
  if (!workers_ || count < 2) {
    for (std::size_t i = 0; i < count; ++i) call(task, i);
    return;
  }
  // A oneTBB task costs about 40 ns, and stealing one costs much more, so there is at most one oneTBB task
  // per thread. Each oneTBB task first works through its own part of the indices. (With more than
  // k_most_parts oneTBB tasks, several of them share a part.) This part is the same in all loops with the
  // same count, so that its data are often still in the caches of the core. Then the oneTBB task helps with
  // the other parts.
  struct alignas(64) Part {  // one cache line each
    std::atomic<std::size_t> next = 0;
    std::size_t end = 0;
  };
  std::array<Part, k_most_parts> parts;
  const std::size_t runners = std::min<std::size_t>(threads_, count);
  const std::size_t used = std::min(runners, k_most_parts);
  for (std::size_t p = 0; p < used; ++p) {
    parts[p].next.store(count * p / used, std::memory_order_relaxed);
    parts[p].end = count * (p + 1) / used;
  }
  workers_->arena.execute([&] {
    tbb::parallel_for(
        std::size_t{0}, runners,
        [&](std::size_t own) {
          // The environment is restored here and not in a task_scheduler_observer, because oneTBB leaks the
          // memory of such observers.
          thread_local const bool ready = (restore_fp_environment(), true);
          static_cast<void>(ready);
          for (std::size_t p = 0; p < used; ++p) {
            Part& part = parts[(own + p) % used];
            while (part.next.load(std::memory_order_relaxed) < part.end) {
              const std::size_t i = part.next.fetch_add(1, std::memory_order_relaxed);
              if (i < part.end) call(task, i);
            }
          }
        },
        tbb::simple_partitioner{});
  });
}

}  // namespace troupe::partition
