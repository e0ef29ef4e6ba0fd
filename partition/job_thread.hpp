#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace troupe::partition {

/// A thread that runs jobs, such as drawing and writing files, in the order in which they were added, while
/// the thread that adds them continues. The time steps of a simulated world do not use this class. They run
/// in parallel loops (class Parallel).
///
/// After a job throws, the waiting jobs are dropped, no further job starts, and every call of rethrow(),
/// add() and finish() throws the exception of that job.
class JobThread {
 public:
  /// most_waiting: largest number of jobs that have not started, at least 1. This number limits the memory in
  /// use, because each of these jobs may hold a large copy of the state of a world.
  explicit JobThread(std::size_t most_waiting);
  /// Drops the jobs that have not started and waits for the running job. Discards the exception of a job that
  /// has thrown.
  ~JobThread();
  JobThread(const JobThread&) = delete;
  JobThread& operator=(const JobThread&) = delete;

  /// Adds a job. Blocks while `most_waiting` jobs have not started.
  void add(std::function<void()> job);
  /// Blocks until every added job is done.
  void finish();
  /// Throws the exception of the job that threw, if one did so far. Does not wait for jobs.
  void rethrow();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe::partition
