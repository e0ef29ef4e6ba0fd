#pragma once

#include "apps/observers/observer.hpp"

#include <chrono>
#include <cstdint>

namespace troupe::apps {

/// Prints the progress of a run on standard error, one line for every tick (time step) that is a
/// multiple of `every_ticks`. An example is `arena: 60 s, 812.4 x real time`: the title of the world, the
/// simulated time, and the mean speed since the run began. The line for the tick at which the run begins has
/// no speed.
class ClockLines : public Observer {
 public:
  /// every_ticks: interval of the lines, ticks, at least 1
  /// simulation: the simulation at the beginning of the run
  ClockLines(std::uint64_t every_ticks, const Simulation& simulation);

  void observe(const Simulation& simulation) override;
  bool reads_robots() const override { return false; }

 private:
  using WallClock = std::chrono::steady_clock;
  std::uint64_t every_ticks_;
  double first_s_;  // simulated time at which the run began
  WallClock::time_point start_ = WallClock::now();
};

}  // namespace troupe::apps
