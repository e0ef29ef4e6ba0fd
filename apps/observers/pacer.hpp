#pragma once

#include "apps/observers/observer.hpp"

#include <chrono>
#include <functional>

namespace troupe::apps {

/// Keeps a run from being faster than `rate` times real time: after each tick it waits until the tick is due.
/// A run that cannot keep up goes as fast as it can. One that fell behind by more than a second (the machine
/// slept, or the run was stopped for a while) does not race to catch up, but goes on at its rate from there.
class Pacer : public Observer {
 public:
  /// `is_over` ends a wait early: the run was asked to stop.
  Pacer(double rate, std::function<bool()> is_over);

  void observe(const Simulation& simulation) override;
  /// Wall time that was spent in waiting, s.
  double waited_s() const { return waited_s_; }

 private:
  using Clock = std::chrono::steady_clock;
  void wait_until(Clock::time_point due);

  double rate_;
  std::function<bool()> is_over_;
  bool begun_ = false;
  double begun_at_s_ = 0;       // of world time
  Clock::time_point begun_at_;  // the same moment
  double waited_s_ = 0;
};

}  // namespace troupe::apps
