#include "partition/parallel.hpp"

#include "base/fp_environment.hpp"
#include "partition/job_thread.hpp"

#include <pthread.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <optional>
#include <system_error>
#include <vector>

namespace troupe::partition {
namespace {

constexpr std::size_t k_most_parts = 64;

void* wait_for_mutex(void* mutex) {
  const std::lock_guard lock(*static_cast<std::mutex*>(mutex));
  return nullptr;
}

/// Throws the error of throw_no_thread() if the system does not let oneTBB start as many threads as a loop
/// needs: starts and ends so many threads. oneTBB starts some of its threads in others of its threads, where
/// its exception "pthread_create has failed" would end the program. All loops share the threads of oneTBB, so
/// this function starts threads only if a loop needs more of them than all loops before.
/// count: number of threads without the calling thread
void require_threads(unsigned count) {
  static std::atomic<unsigned> most = 0;  // the most threads that a loop has needed
  const unsigned before = most.load(std::memory_order_relaxed);
  if (count <= before) return;
  std::mutex mutex;
  std::vector<pthread_t> threads(count - before);
  std::size_t started = 0;
  int error = 0;
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes,
                            tbb::global_control::active_value(tbb::global_control::thread_stack_size));
  {
    const std::lock_guard lock(mutex);  // no thread ends before all are started
    while (started < threads.size() && error == 0) {
      error = pthread_create(&threads[started], &attributes, wait_for_mutex, &mutex);
      if (error == 0) ++started;
    }
  }
  pthread_attr_destroy(&attributes);
  for (std::size_t i = 0; i < started; ++i) pthread_join(threads[i], nullptr);
  if (error != 0) throw_no_thread(std::system_error(error, std::generic_category()));
  most.store(count, std::memory_order_relaxed);
}

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
  require_threads(threads_ - 1);
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
