#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <system_error>

namespace troupe::partition {

/// Throws a std::system_error with the code of `error` and a text that says which limits to raise. For an
/// error of starting a thread, whose own text is only "Resource temporarily unavailable".
[[noreturn]] void throw_no_thread(const std::system_error& error);

/// Starts `count` threads, all of which exist at the same time, and ends them. Returns the error of the
/// system if it allows fewer threads, otherwise an error code of value 0. For libraries that start threads of
/// their own, and that end the program or wait for ever if they cannot start them. stack_bytes: size of the
/// stack of each thread; 0: the default of the system
[[nodiscard]] std::error_code try_threads(std::size_t count, std::size_t stack_bytes = 0);

/// A thread that runs jobs, such as drawing and writing files, in the order in which they were added. The
/// thread that adds the jobs continues meanwhile. The time steps of a simulated world do not use this class;
/// they run in parallel loops (class Parallel). A job must not call the functions of its own JobThread.
///
/// After a job throws, the waiting jobs are dropped and no further job starts. From then on, every call of
/// rethrow(), add() and finish() throws the exception of that job.
class JobThread {
 public:
  /// Starts the thread. Throws the error of throw_no_thread() if this fails. most_waiting: largest number of
  /// jobs that wait for their start, at least 1. This number limits the memory in use, because each waiting
  /// job may hold a large copy of the state of a world.
  explicit JobThread(std::size_t most_waiting);
  /// Drops the waiting jobs and waits for the running job. Discards the exception of a job that has thrown.
  ~JobThread();
  JobThread(const JobThread&) = delete;
  JobThread& operator=(const JobThread&) = delete;

  /// Adds a job. Blocks while `most_waiting` (see the constructor) jobs are waiting.
  void add(std::function<void()> job);
  /// Blocks until all jobs that were added are done.
  void finish();
  /// Throws the exception of the job that has thrown, if there is one. Does not wait for jobs.
  void rethrow();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe::partition
