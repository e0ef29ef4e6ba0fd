#include "partition/parallel.hpp"

#include "base/scoped_flag.hpp"
#include "partition/processors.hpp"

#include <exception>
#include <mutex>
#include <stdexcept>
#include <string>

namespace troupe::partition {
namespace {

/// The tasks of a loop. Catches their exceptions and keeps that of the task with the lowest index.
struct Guarded {
  void (*call)(void* task, std::size_t i);
  void* task;
  const std::function<void(std::size_t, bool)>& on_task;
  std::mutex mutex;
  std::size_t lowest = 0;
  std::exception_ptr exception;

  static void run(void* self, std::size_t i) {
    auto& guarded = *static_cast<Guarded*>(self);
    try {
      guarded.call(guarded.task, i);
    } catch (...) {
      const std::lock_guard lock(guarded.mutex);
      if (guarded.exception && guarded.lowest < i) return;
      guarded.lowest = i;
      guarded.exception = std::current_exception();
    }
  }

  static void run_watched(void* self, std::size_t i) {
    const auto& on_task = static_cast<Guarded*>(self)->on_task;
    on_task(i, true);
    run(self, i);
    on_task(i, false);
  }
};

}  // namespace

unsigned Parallel::checked(unsigned threads) {
  if (threads > k_most_threads)
    throw std::invalid_argument(std::to_string(threads) + " threads: must be 1 to " +
                                std::to_string(k_most_threads) +
                                ", or 0 for one per processor that the process may use");
  return threads > 0 ? threads : processors_allowed();
}

void Parallel::run(std::size_t count, Call call, void* task) {
  if (is_in_loop_)
    throw std::logic_error(
        "a parallel loop must not begin in a task of another loop of the same world: compute hashes and "
        "measures outside of functions that are called for many robots at once");
  const ScopedFlag in_loop(is_in_loop_);
  Guarded guarded{.call = call, .task = task, .on_task = on_task_};
  if (on_loop_) on_loop_(true);
  run_tasks(count, on_task_ ? Guarded::run_watched : Guarded::run, &guarded);
  if (on_loop_) on_loop_(false);
  if (guarded.exception) std::rethrow_exception(guarded.exception);
}

}  // namespace troupe::partition
