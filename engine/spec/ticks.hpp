#pragma once

#include <cstdint>

namespace troupe::engine {

/// Longest time or interval that a world file or an option may give, s. The number of ticks in such a time
/// fits 64 bits.
inline constexpr double k_most_seconds = 1e9;

/// Converts a period from seconds to ticks, rounded up to a whole number as in Stage. The result is at least
/// 1 (also for 0, negative numbers and NaN) and at most 1e15. 0.3 s are 3 ticks of 0.1 s, although their
/// quotient in floating point is not exactly 3. `tick_s` must be above 0.
std::uint64_t period_ticks(double period_s, double tick_s);

/// Number of the first tick that ends at the world time `end_s` or later, counted from 1; at most 1e15, and 0
/// if `end_s` is not above 0. A tick that ends earlier by at most a tolerance also counts, even tick 0; the
/// tolerance is 1e-9 times the larger of `tick_s` and `end_s`. So 0.7 s are 7 ticks of 0.1 s, although
/// neither number is exact in binary. `tick_s` must be above 0.
std::uint64_t ticks_until(double end_s, double tick_s);

}  // namespace troupe::engine
