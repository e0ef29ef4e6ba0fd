#include "partition/parallel.hpp"

#include "base/fp_environment.hpp"
#include "partition/job_thread.hpp"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <system_error>
#include <utility>

namespace troupe::partition {
namespace {

constexpr std::size_t k_most_parts = 64;

/// An arena of oneTBB: loops in it run on a fixed number of threads.
struct Arena {
  explicit Arena(unsigned thread_count) : threads(thread_count), arena(static_cast<int>(thread_count)) {}

  const unsigned threads;
  tbb::task_arena arena;
  bool has_threads = false;     ///< whether require_threads() has succeeded
  std::unique_ptr<Arena> next;  ///< in FreeArenas
};

/// The arenas of destroyed objects, for new objects. They are never destroyed, so that oneTBB keeps its
/// threads. An arena keeps its threads for some time after a loop. The loops of a new arena would meanwhile
/// get further threads, which the system may not allow.
class FreeArenas {
 public:
  /// Returns a free arena for so many threads, or a new one, which is not initialized yet.
  static std::unique_ptr<Arena> take(unsigned threads) {
    FreeArenas& all = instance();
    const std::lock_guard lock(all.mutex_);
    std::unique_ptr<Arena>* link = &all.first_;
    while (*link && (*link)->threads != threads) link = &(*link)->next;
    if (!*link) return std::make_unique<Arena>(threads);
    std::unique_ptr<Arena> taken = std::move(*link);
    *link = std::move(taken->next);
    return taken;
  }

  static void give_back(std::unique_ptr<Arena> arena) {
    FreeArenas& all = instance();
    const std::lock_guard lock(all.mutex_);
    arena->next = std::move(all.first_);
    all.first_ = std::move(arena);
  }

 private:
  static FreeArenas& instance() {
    static auto* const arenas = new FreeArenas;
    return *arenas;
  }

  std::mutex mutex_;
  std::unique_ptr<Arena> first_;  // of a list
};

/// Throws the error of throw_no_thread() if the system does not let oneTBB start the threads that an arena
/// may use in addition to those of all other arenas. oneTBB starts some of its threads in others of its
/// threads, where its exception "pthread_create has failed" would end the program. count: number of threads
/// of the arena without the calling thread
void require_threads(unsigned count) {
  static std::mutex mutex;
  static std::size_t required = 0;  // for all arenas
  const std::lock_guard lock(mutex);
  const std::size_t most =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism) - 1;
  const std::size_t further = std::min<std::size_t>(count, most - std::min(most, required));
  const std::error_code error =
      try_threads(further, tbb::global_control::active_value(tbb::global_control::thread_stack_size));
  if (error) throw_no_thread(std::system_error(error));
  required += further;
}

}  // namespace

struct Parallel::Workers {
  explicit Workers(unsigned threads) : held(FreeArenas::take(threads)) {
    // By default oneTBB runs at most as many threads as the process had processors when oneTBB started. If an
    // arena asks for more, oneTBB ignores this and prints a warning to standard error. A global_control
    // raises the limit. If there are several global_control objects, the least of their limits applies, so
    // all of them set the same limit, k_most_threads.
    if (threads > static_cast<unsigned>(tbb::info::default_concurrency()))
      limit.emplace(tbb::global_control::max_allowed_parallelism, k_most_threads);
    held->arena.initialize();  // without effect if it is initialized
  }
  ~Workers() { FreeArenas::give_back(std::move(held)); }

  /// Returns the arena for a loop. Throws the error of require_threads() if the arena may not use its
  /// threads.
  tbb::task_arena& arena() {
    if (!held->has_threads) require_threads(held->threads - 1);
    held->has_threads = true;
    return held->arena;
  }

  std::optional<tbb::global_control> limit;
  std::unique_ptr<Arena> held;
};

Parallel::Parallel(unsigned threads) : threads_(checked(threads)) {
  restore_fp_environment();
  if (threads_ > 1) workers_ = std::make_unique<Workers>(threads_);
}

Parallel::~Parallel() = default;
Parallel::Parallel(Parallel&&) noexcept = default;

void Parallel::run_tasks(std::size_t count, Call call, void* task) {
  if (!workers_ || count < 2) {
    for (std::size_t i = 0; i < count; ++i) call(task, i);
    return;
  }
  tbb::task_arena& arena = workers_->arena();
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
  arena.execute([&] {
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
