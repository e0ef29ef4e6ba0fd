#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace troupe::partition {

/// A thread that does one job after another, in the order in which they were added, while the thread that
/// adds them goes on: drawing, writing files. The step itself runs on Parallel alone.
///
/// After a job that throws no other job begins: rethrow(), add() and finish() throw its exception, each time.
class JobThread {
 public:
  /// most_waiting: jobs that have been added and have not begun, at least 1. What a job holds, the copy of a
  /// tick, is large.
  explicit JobThread(std::size_t most_waiting);
  /// Drops the jobs that have not begun, and waits for the one that has.
  ~JobThread();
  JobThread(const JobThread&) = delete;
  JobThread& operator=(const JobThread&) = delete;

  /// Waits while `most_waiting` jobs wait, then adds one.
  void add(std::function<void()> job);
  /// Waits until every job is done.
  void finish();
  /// Does nothing unless a job has thrown.
  void rethrow();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe::partition
