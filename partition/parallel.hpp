#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>

namespace troupe::partition {

/// Runs parallel loops on several threads. A simulated world does all parallel work of a time step through
/// this class.
///
/// There are two equivalent backends: oneTBB, and plain std::thread (CMake option TROUPE_STD_THREADS), which
/// the thread sanitizer understands. The constructor restores the default floating-point environment
/// (base/fp_environment.hpp) of the calling thread, and each worker thread restores its own environment
/// before its first task. One thread at a time may use an object.
class Parallel {
 public:
  static constexpr unsigned k_most_threads = 1024;  ///< largest number of threads

  /// threads: number of threads; 0 means one per processor that the process may use
  /// (partition/processors.hpp). Throws std::invalid_argument for more than k_most_threads. If `threads` is
  /// more than oneTBB allows by default, the constructor raises oneTBB's limit for the whole process. If the
  /// system allows too few threads, the constructor of the backend std::thread, or the first loop of the
  /// backend oneTBB, throws the error of throw_no_thread() (partition/job_thread.hpp).
  /// The backend oneTBB keeps its threads until the process ends. New objects use the threads of destroyed
  /// objects. If objects start their first loops at the same time, and the system does not allow the threads
  /// of all of them together, oneTBB may end the program.
  explicit Parallel(unsigned threads);
  ~Parallel();
  Parallel(Parallel&&) noexcept;  ///< the moved-from object can only be destroyed

  unsigned threads() const { return threads_; }  ///< number of threads, at least 1

  /// Sets a callback for profilers. The thread that runs a task calls the callback before the task (`begins`
  /// is true) and after the task (`begins` is false), with the index of the task in its loop. Several threads
  /// may call the callback at once, so it must be thread-safe. It must not throw. An empty function removes
  /// the callback; without a callback, tasks have no overhead. Call on_task() between loops only.
  void on_task(std::function<void(std::size_t task, bool begins)> callback) {
    on_task_ = std::move(callback);
  }

  /// Sets a callback for timing. The thread that calls for_each() calls the callback before the loop
  /// (`begins` is true) and after the loop (`begins` is false). It must not throw. Call on_loop() between
  /// loops only.
  void on_loop(std::function<void(bool begins)> callback) { on_loop_ = std::move(callback); }

  /// Calls task(i) once for each i from 0 to count - 1 and returns when all calls are done. The calls run in
  /// any order, on the worker threads and the calling thread. Tasks should be coarse (some tens of
  /// microseconds), and must write only data that no other task of the loop reads or writes. In a task,
  /// for_each() of the same object throws std::logic_error. If tasks throw, the others still run; then the
  /// exception of the task with the lowest index is rethrown.
  template <class Task>
  void for_each(std::size_t count, Task&& task) {
    run(
        count, [](void* t, std::size_t i) { (*static_cast<std::remove_reference_t<Task>*>(t))(i); }, &task);
  }

  /// Divides the indices 0 to count - 1 into batches of `size` consecutive indices; the last batch may have
  /// fewer. Calls work(first, end) for each batch, which has the indices `first` to end - 1. Each call is a
  /// task of for_each(). `size` must be at least 1.
  template <class Work>
  void for_batches(std::size_t count, std::size_t size, Work&& work) {
    for_each((count + size - 1) / size,
             [&](std::size_t b) { work(b * size, std::min(count, (b + 1) * size)); });
  }

 private:
  using Call = void (*)(void* task, std::size_t i);
  void run(std::size_t count, Call call, void* task);
  void run_tasks(std::size_t count, Call call, void* task);  // defined by the backend; tasks must not throw
  static unsigned checked(unsigned threads);                 // replaces 0 by its meaning; throws for too many

  struct Workers;
  unsigned threads_;
  bool is_in_loop_ = false;
  std::unique_ptr<Workers> workers_;
  std::function<void(std::size_t, bool)> on_task_;
  std::function<void(bool)> on_loop_;
};

}  // namespace troupe::partition
