#pragma once

#include "engine/state/phase.hpp"

#include <array>
#include <chrono>
#include <cstddef>
#include <optional>

namespace troupe::apps {

/// Measures how much wall time each phase of the ticks takes. A tick is a time step; a phase is a part
/// of a tick, such as sense or move. A callback of Simulation::on_phase() must call operator() with each
/// value that the callback receives: the phase that begins, or std::nullopt when a tick ends.
class PhaseClock {
 public:
  using Clock = std::chrono::steady_clock;

  void operator()(std::optional<engine::Phase> phase) {
    const auto now = Clock::now();
    if (current_)
      seconds_[static_cast<std::size_t>(*current_)] += std::chrono::duration<double>(now - since_).count();
    current_ = phase;
    since_ = now;
  }
  /// Returns the wall time of each phase, summed over all ticks so far, s. The array is indexed by
  /// engine::Phase.
  const std::array<double, engine::k_phases>& seconds() const { return seconds_; }

 private:
  std::array<double, engine::k_phases> seconds_{};
  std::optional<engine::Phase> current_;
  Clock::time_point since_;
};

}  // namespace troupe::apps
