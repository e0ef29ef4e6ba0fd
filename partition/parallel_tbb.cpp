#include "partition/parallel.hpp"

#include "base/fp_environment.hpp"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <optional>
#include <thread>

namespace troupe::partition {

struct Parallel::Workers {
  explicit Workers(unsigned threads) : arena(static_cast<int>(threads)) {
    // Left alone, oneTBB runs no more threads than there are cores, whatever an arena asks for, and complains
    // on standard error. Of several such limits the least counts, so each asks for the same plenty.
    constexpr std::size_t k_plenty = 256;
    if (threads > std::thread::hardware_concurrency())
      limit.emplace(tbb::global_control::max_allowed_parallelism, std::max<std::size_t>(threads, k_plenty));
    arena.initialize();
  }

  std::optional<tbb::global_control> limit;
  tbb::task_arena arena;
};

Parallel::Parallel(unsigned threads)
    : threads_(threads > 0 ? threads : std::max(1u, std::thread::hardware_concurrency())) {
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
  workers_->arena.execute([&] {
    tbb::parallel_for(
        std::size_t{0}, count,
        [&](std::size_t i) {
          // Not a task_scheduler_observer, which oneTBB leaks.
          thread_local const bool ready = (restore_fp_environment(), true);
          static_cast<void>(ready);
          call(task, i);
        },
        tbb::simple_partitioner{});
  });
}

}  // namespace troupe::partition
