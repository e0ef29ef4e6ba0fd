#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace troupe::partition {

/// The one parallel loop. Everything that runs on several cores runs through it.
///
/// Two backends with the same meaning: oneTBB, and plain std::thread (TROUPE_STD_THREADS), which the thread
/// sanitizer can see through. Each worker's floating-point environment is put right before its first task.
class Parallel {
 public:
  static constexpr unsigned k_most_threads = 1024;  ///< that one loop may have

  /// threads 0: one for each processor that the process may use (partition/processors.hpp). Throws
  /// std::invalid_argument for more than k_most_threads.
  explicit Parallel(unsigned threads);
  ~Parallel();
  /// The moved-from one can only be destroyed or assigned to.
  ///@{
  Parallel(Parallel&&) noexcept;
  Parallel& operator=(Parallel&&) noexcept;
  ///@}

  unsigned threads() const { return threads_; }  ///< at least 1

  /// Called on its worker as a task begins (true) and ends (false), with the task's index in its loop; on
  /// several workers at once, so it must be thread-safe. For profiles: without one no task pays for it. Set
  /// between loops.
  void on_task(std::function<void(std::size_t task, bool begins)> callback) {
    on_task_ = std::move(callback);
  }

  /// Called on the caller's thread as each loop begins (true) and ends (false); for timing. Set between
  /// loops.
  void on_loop(std::function<void(bool begins)> callback) { on_loop_ = std::move(callback); }

  /// Calls task(i) once for each i in 0 .. count-1, in any order, on any worker; returns when all are done.
  /// Tasks must be coarse (some tens of microseconds), and must write only what no other task of the loop
  /// reads or writes. Where tasks throw, the others still run, and then the exception of the lowest index
  /// comes out. With more threads than oneTBB would make by itself its limit for the whole process is raised.
  template <class Task>
  void for_each(std::size_t count, Task&& task) {
    run(
        count, [](void* t, std::size_t i) { (*static_cast<std::remove_reference_t<Task>*>(t))(i); }, &task);
  }

 private:
  using Call = void (*)(void* task, std::size_t i);
  void run(std::size_t count, Call call, void* task);
  void run_tasks(std::size_t count, Call call, void* task);  // of the backend; tasks do not throw
  static unsigned checked(unsigned threads);                 // what the constructor makes of its argument

  struct Workers;
  unsigned threads_;
  std::unique_ptr<Workers> workers_;
  std::function<void(std::size_t, bool)> on_task_;
  std::function<void(bool)> on_loop_;
};

}  // namespace troupe::partition
