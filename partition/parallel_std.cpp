#include "partition/parallel.hpp"

#include "base/fp_environment.hpp"
#include "partition/job_thread.hpp"

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace troupe::partition {

/// The worker threads wait until `loop`, the number of loops begun so far, changes. Then they take the
/// indices of tasks from the counter `next` until there are no more, and report that they are done. The
/// calling thread takes indices as well. Before a worker waits, it compares `loop` with the value of `loop`
/// that it saw last, so that it does not miss a loop that began before the wait.
struct Parallel::Workers {
  explicit Workers(unsigned helpers) {
    try {
      for (unsigned i = 0; i < helpers; ++i) threads.emplace_back([this] { serve(); });
    } catch (const std::system_error& error) {
      stop();  // a std::thread that was not joined would end the program
      throw_no_thread(error);
    }
  }
  ~Workers() { stop(); }

  void stop() {
    {
      const std::lock_guard lock(mutex);
      stopping = true;
    }
    wake.notify_all();
    for (std::thread& t : threads) t.join();
  }

  void serve() {
    restore_fp_environment();
    std::uint64_t seen = 0;
    for (;;) {
      {
        std::unique_lock lock(mutex);
        wake.wait(lock, [&] { return stopping || loop != seen; });
        if (stopping) return;
        seen = loop;
      }
      work();
      const std::lock_guard lock(mutex);
      if (--busy == 0) done.notify_one();
    }
  }
  void work() {
    for (std::size_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < count;) call(task, i);
  }

  std::mutex mutex;
  std::condition_variable wake;
  std::condition_variable done;
  std::uint64_t loop = 0;
  std::size_t busy = 0;
  bool stopping = false;
  std::size_t count = 0;
  Call call = nullptr;
  void* task = nullptr;
  std::atomic<std::size_t> next = 0;
  std::vector<std::thread> threads;
};

Parallel::Parallel(unsigned threads) : threads_(checked(threads)) {
  restore_fp_environment();
  if (threads_ > 1) workers_ = std::make_unique<Workers>(threads_ - 1);
}

Parallel::~Parallel() = default;
Parallel::Parallel(Parallel&&) noexcept = default;

void Parallel::run_tasks(std::size_t count, Call call, void* task) {
  if (!workers_ || count < 2) {
    for (std::size_t i = 0; i < count; ++i) call(task, i);
    return;
  }
  Workers& w = *workers_;
  {
    const std::lock_guard lock(w.mutex);
    w.count = count;
    w.call = call;
    w.task = task;
    w.next.store(0, std::memory_order_relaxed);
    w.busy = w.threads.size();
    ++w.loop;
  }
  w.wake.notify_all();
  w.work();
  std::unique_lock lock(w.mutex);
  w.done.wait(lock, [&] { return w.busy == 0; });
}

}  // namespace troupe::partition
