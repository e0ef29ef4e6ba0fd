#pragma once

#include "base/random.hpp"
#include "engine/spec/ticks.hpp"

#include <algorithm>
#include <cstdint>

namespace troupe::models {

/// Longest duration that a controller counts, in decisions. A decision is one call of a controller. The
/// functions below return this number for longer durations, so that results fit counters of 32 bits.
inline constexpr std::uint32_t k_most_decisions = 1'000'000'000;

/// Returns the number of whole decisions (calls of a controller) in a duration: seconds / period_s, rounded
/// down. If the quotient is below a whole number only by a rounding error, the result is this whole number
/// (engine::ticks_within()). The result may be 0, and is at most k_most_decisions. Controllers use it for
/// durations that are random or that the user gives.
///
/// seconds: the duration, s, at least 0
/// period_s: time from one decision to the next (Percept::period_s), s, above 0
inline std::uint32_t whole_decisions(double seconds, double period_s) {
  return static_cast<std::uint32_t>(
      std::min<std::uint64_t>(engine::ticks_within(seconds, period_s), k_most_decisions));
}

/// Returns the number of decisions (calls of a controller) that together last `seconds` or longer:
/// seconds / period_s, rounded up. If the quotient exceeds a whole number only by a rounding error, the
/// result is this whole number (engine::period_ticks()). The result is at least 1 and at most
/// k_most_decisions. Controllers use it for durations that must not end early. Arguments as for
/// whole_decisions().
inline std::uint32_t decisions_for(double seconds, double period_s) {
  return static_cast<std::uint32_t>(
      std::min<std::uint64_t>(engine::period_ticks(seconds, period_s), k_most_decisions));
}

/// Returns a random number of decisions (calls of a controller), for a random duration between `least_s` and
/// `least_s` + `spread_s`, s. The result is decisions_for(least_s, period_s) plus a random whole number from
/// 0 to decisions_for(spread_s, period_s) - 1; all of these numbers are equally likely.
///
/// period_s: as for whole_decisions()
/// random: generator of the random number
inline std::uint32_t random_decisions(double least_s, double spread_s, double period_s, Random& random) {
  return decisions_for(least_s, period_s) + random.below(decisions_for(spread_s, period_s));
}

}  // namespace troupe::models
