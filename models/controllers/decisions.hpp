#pragma once

#include "base/random.hpp"
#include "engine/spec/ticks.hpp"

#include <algorithm>
#include <cstdint>

namespace troupe::models {

/// Longest duration of a controller, in decisions (calls of the controller). Longer durations are cut to this
/// number, which the counters in the memories of controllers can hold.
inline constexpr std::uint32_t k_most_decisions = 1'000'000'000;

/// Number of whole decisions in a duration, for durations that are random or that the user gives. The result
/// is rounded down, may be 0, and is at most k_most_decisions. seconds: the duration, s, at least 0.
/// period_s: Percept::period_s, above 0.
inline std::uint32_t whole_decisions(double seconds, double period_s) {
  return static_cast<std::uint32_t>(std::min<double>(seconds / period_s, k_most_decisions));
}

/// Number of decisions that together last `seconds` or longer, for durations that must not end early. The
/// result is rounded up as by engine::period_ticks(), so it is at least 1; it is at most k_most_decisions.
/// Arguments: as for whole_decisions().
inline std::uint32_t decisions_for(double seconds, double period_s) {
  return static_cast<std::uint32_t>(
      std::min<std::uint64_t>(engine::period_ticks(seconds, period_s), k_most_decisions));
}

/// A random number of decisions, at least decisions_for(least_s), for durations from `least_s` to less than
/// `least_s` + `spread_s`, s. It draws one number from `random`. period_s: as for whole_decisions().
inline std::uint32_t random_decisions(double least_s, double spread_s, double period_s, Random& random) {
  return decisions_for(least_s, period_s) + random.below(decisions_for(spread_s, period_s));
}

}  // namespace troupe::models
