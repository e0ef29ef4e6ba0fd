#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace troupe::apps {

/// Does one job after another on a thread of its own, in the order in which they came. Whoever brings jobs
/// faster than they are done waits for room: what a job holds, the copy of a tick, is large.
class DrawingThread {
 public:
  explicit DrawingThread(std::size_t most_waiting);
  /// Drops the jobs that have not begun, and waits for the one that has.
  ~DrawingThread();
  DrawingThread(const DrawingThread&) = delete;
  DrawingThread& operator=(const DrawingThread&) = delete;

  /// Throws what an earlier job threw; no job runs behind that one.
  void add(std::function<void()> job);
  /// Waits until every job is done. Throws what one threw.
  void finish();

 private:
  void run();
  void throw_if_failed(std::unique_lock<std::mutex>& lock);

  std::size_t most_waiting_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> jobs_;
  bool is_busy_ = false;
  bool is_over_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace troupe::apps
