#pragma once

#include "apps/per_thread.hpp"

#include <algorithm>
#include <chrono>

namespace troupe::apps {

/// Measures how evenly the ticks (time steps) of a run load the worker threads. A task is a part of a
/// parallel loop; one thread runs the task. A run calls tick(), loop() and task() from its callbacks of
/// Simulation::on_phase(), on_loop() and on_task(). Loops between ticks, such as those for hashes and
/// measures, are not counted.
///
/// The cost is two clock readings per task. This is little, because a task takes tens of microseconds.
class LoadClock {
 public:
  /// Call it with true when a tick begins and with false when it has ended. Repeated calls with the same
  /// value have no effect.
  void tick(bool is_under_way) {
    if (is_under_way == is_tick_) return;
    is_tick_ = is_under_way;
    mark(tick_, is_under_way, ticks_s_);
  }
  /// Call it when a parallel loop begins (true) or ends (false), on the thread that steps the simulation.
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
  /// Call it when a task of the loop begins (true) or ends (false), on the thread that runs the task.
  void task(bool begins) {
    if (!is_tick_) return;  // not a data race, because is_tick_ is written only between loops
    Worker& worker = workers_.own();
    mark(worker.begin, begins, worker.busy_s);
  }

  /// Returns the fraction of the wall time of all ticks that was spent outside parallel loops, from 0 to 1; 0
  /// before the first tick. More worker threads do not shorten this part of the time.
  double serial_share() const { return ticks_s_ > 0 ? 1 - loops_s_ / ticks_s_ : 0; }
  /// Returns how unevenly the loops loaded the workers: 1 if all workers had equal work, `threads` if one
  /// worker did everything, 0 if no task was run. The result is a ratio. The numerator is the time of the
  /// busiest worker in a loop, summed over all loops. The denominator is the time of all tasks, divided by
  /// `threads`, the number of workers.
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
  double longest_s_ = 0;  // sum over loops of the busiest worker's time
  PerThread<Worker> workers_;
};

}  // namespace troupe::apps
