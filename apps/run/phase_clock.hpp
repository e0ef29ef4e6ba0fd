#pragma once

#include "engine/world/phase.hpp"

#include <array>
#include <chrono>
#include <cstddef>
#include <optional>

namespace troupe::apps {

/// Sums the wall time of each phase over all ticks. A tick is a simulation step; a phase is a part of it,
/// such as sense or move. Call it, in a callback of Simulation::on_phase(), with the phase that begins, and
/// with std::nullopt when a tick ends.
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
  /// Wall time of each phase, s.
  const std::array<double, engine::k_phases>& seconds() const { return seconds_; }

 private:
  std::array<double, engine::k_phases> seconds_{};
  std::optional<engine::Phase> current_;
  Clock::time_point since_;
};

}  // namespace troupe::apps
