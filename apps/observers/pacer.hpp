#pragma once

#include "apps/observers/observer.hpp"

#include <chrono>
#include <functional>

namespace troupe::apps {

/// Limits the speed of a run to `rate` times real time: after each tick (time step), observe() waits
/// until the wall time at which this tick is due. A run that is slower than its rate never waits. If a run
/// has fallen behind by more than one second, for example because the process was suspended, it does not
/// catch up: from then on it continues at its rate.
class Pacer : public Observer {
 public:
  /// rate: largest speed, in multiples of real time, above 0. is_over: a function that returns true if the
  /// run must stop. It is called about every 50 ms during a wait, and ends the wait when it returns true.
  Pacer(double rate, std::function<bool()> is_over);

  void observe(const Simulation& simulation) override;
  bool reads_robots() const override { return false; }
  /// Wall time spent waiting, s.
  double waited_s() const { return waited_s_; }

 private:
  using Clock = std::chrono::steady_clock;
  void wait_until(Clock::time_point due);

  double rate_;
  std::function<bool()> is_over_;
  bool begun_ = false;
  double begun_at_s_ = 0;       // simulated time
  Clock::time_point begun_at_;  // wall time of the same moment
  double waited_s_ = 0;
};

}  // namespace troupe::apps
