#pragma once

#include "base/random.hpp"
#include "engine/spec/ticks.hpp"

#include <algorithm>
#include <cstdint>

namespace troupe::models {

/// Longest duration that a controller counts, in decisions (calls of the controller). The functions below cut
/// longer durations to this number, so that counters of 32 bits can hold them.
inline constexpr std::uint32_t k_most_decisions = 1'000'000'000;

/// Returns the number of decisions (calls of the controller) that fit into a duration, rounded down.
/// Controllers use it for durations that are random or that the user gives. The result may be 0, and is at
/// most k_most_decisions. seconds: the duration, s, at least 0. period_s: the time between two decisions
/// (Percept::period_s), s, above 0.
inline std::uint32_t whole_decisions(double seconds, double period_s) {
  return static_cast<std::uint32_t>(std::min<double>(seconds / period_s, k_most_decisions));
}

/// Returns the number of decisions (calls of the controller) that together last `seconds` or longer.
/// Controllers use it for durations that must not end early. The result is rounded up, and is at least 1 and
/// at most k_most_decisions. Rounding errors of the division do not add a decision (engine::period_ticks()).
/// Arguments: as for whole_decisions().
inline std::uint32_t decisions_for(double seconds, double period_s) {
  return static_cast<std::uint32_t>(
      std::min<std::uint64_t>(engine::period_ticks(seconds, period_s), k_most_decisions));
}

/// Returns a random number of decisions (calls of the controller), for a random duration between `least_s`
/// and `least_s` + `spread_s`, s. The number is at least decisions_for(least_s) and less than
/// decisions_for(least_s) + decisions_for(spread_s). The function takes one number from the random number
/// generator `random`. period_s: as for whole_decisions().
inline std::uint32_t random_decisions(double least_s, double spread_s, double period_s, Random& random) {
  return decisions_for(least_s, period_s) + random.below(decisions_for(spread_s, period_s));
}

}  // namespace troupe::models
