#pragma once

#include <chrono>
#include <cstdint>

namespace troupe {
class Simulation;
}  // namespace troupe

namespace troupe::live {

class Request;

/// The clock of a run that viewers watch: it tells whether the run is paused and when its next tick is due. A
/// new clock is paused. The simulation must outlive it.
class RunClock {
 public:
  using Clock = std::chrono::steady_clock;

  /// rate: limit of the speed, as a multiple of real time; 0: no limit. Throws std::invalid_argument if
  /// is_rate(rate) (live/view.hpp) is false.
  RunClock(const Simulation& simulation, double rate);

  bool is_playing() const { return playing_; }
  double rate() const { return rate_; }
  /// The current speed, as a multiple of real time, rounded to 0.01; 0 if the run is paused.
  double speed() const;
  /// Whether the run is not paused, and its next tick is due at the time `now`.
  bool is_due(Clock::time_point now) const { return playing_ && (rate_ == 0 || now >= due_); }
  Clock::time_point due() const { return due_; }  ///< when the next tick is due, if there is a limit

  /// Lets the run continue, and pauses it after `ticks` ticks; 0: does not pause it.
  void play(std::uint64_t ticks);
  /// Begins to measure the speed of the run, and the time of its next tick, from now. Call it also after the
  /// simulation has returned to tick 0: a request `until` then still pauses the run at its time.
  void restart();
  /// Obeys a request that runs or pauses the world, or limits its speed. Returns false if the request is of
  /// another sort. Throws ActRefused if an argument is invalid.
  bool obey(const Request& request);
  /// Call before each tick, when it is due: computes when the next one is due.
  void begin_tick();
  /// Call after each tick. Returns true if the run is paused from now on.
  bool end_tick();
  /// Call after each tick. Measures the speed twice a second; returns whether this call has measured it.
  bool measure_speed();

 private:
  const Simulation& simulation_;
  bool playing_ = false;
  std::uint64_t steps_ = 0;  // ticks until the next pause; 0: no pause
  std::uint64_t until_ = 0;  // tick of the next pause if a request `until` has set it, else 0
  double rate_;
  Clock::time_point due_;
  Clock::time_point measured_;  // when the speed was last measured
  double measured_s_ = 0;       // simulated time at measured_
  double reached_ = 0;          // the measured speed
};

}  // namespace troupe::live
