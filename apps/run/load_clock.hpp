#pragma once

#include "apps/per_thread.hpp"

#include <algorithm>
#include <chrono>

namespace troupe::apps {

/// How a run's ticks load the workers, from the marks of a simulation's on_phase(), on_loop() and on_task().
/// Loops between ticks (hashes, measures) do not count. Two looks at a clock a task, which takes some tens of
/// microseconds.
class LoadClock {
 public:
  /// A tick is under way, or none is.
  void tick(bool is_under_way) {
    if (is_under_way == is_tick_) return;
    is_tick_ = is_under_way;
    mark(tick_, is_under_way, ticks_s_);
  }
  /// A parallel loop begins or ends; on the thread that steps.
  void loop(bool begins) {
    if (!is_tick_) return;
    mark(loop_, begins, loops_s_);
    if (begins) return;
    double longest = 0;
    for (Worker& worker : workers_.all()) {
      busy_s_ += worker.busy_s;
      longest = std::max(longest, worker.busy_s);
      worker.busy_s = 0;
    }
    longest_s_ += longest;
  }
  /// A task of the loop begins or ends; on its worker.
  void task(bool begins) {
    if (!is_tick_) return;  // written between loops only
    Worker& worker = workers_.own();
    mark(worker.begin, begins, worker.busy_s);
  }

  /// The part of the ticks' wall time that no parallel loop covers, 0 to 1: more workers do not shorten it.
  double serial_share() const { return ticks_s_ > 0 ? 1 - loops_s_ / ticks_s_ : 0; }
  /// The busiest worker's time in the tasks of a loop by the mean of all `threads` workers, all loops taken
  /// together: 1 where all have the same work, `threads` where one did everything.
  double imbalance(unsigned threads) const { return busy_s_ > 0 ? threads * longest_s_ / busy_s_ : 0; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Worker {
    Clock::time_point begin;
    double busy_s = 0;  // in this loop
  };
  static void mark(Clock::time_point& since, bool begins, double& sum_s) {
    const auto now = Clock::now();
    if (begins)
      since = now;
    else
      sum_s += std::chrono::duration<double>(now - since).count();
  }

  bool is_tick_ = false;
  Clock::time_point tick_;
  Clock::time_point loop_;
  double ticks_s_ = 0;
  double loops_s_ = 0;
  double busy_s_ = 0;
  double longest_s_ = 0;  // of each loop the busiest worker's
  PerThread<Worker> workers_;
};

}  // namespace troupe::apps
