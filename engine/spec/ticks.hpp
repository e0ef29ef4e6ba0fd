#pragma once

#include <cstdint>

namespace troupe::engine {

/// Longest time or interval that a world file or an option may give, s. The number of ticks (time steps of a
/// world) in a time of this length fits 64 bits.
inline constexpr double k_most_seconds = 1e9;

/// Converts a period from seconds to ticks, which are time steps of the length `tick_s`, s. The result is
/// rounded up to a whole number, as in the simulator Stage. It is at least 1 (also for 0, negative numbers
/// and NaN) and at most 1e15. A period of 0.3 s is 3 ticks of 0.1 s, although their quotient in floating
/// point is not exactly 3. `tick_s` must be above 0.
std::uint64_t period_ticks(double period_s, double tick_s);

/// Returns the number of the first tick that ends at the world time `end_s`, s, or later. Ticks are time
/// steps of the length `tick_s`, s, counted from 1. The result is 0 if `end_s` is not above 0, and at most
/// 1e15. A tick that ends earlier than `end_s` by at most a tolerance also counts. The tolerance is 1e-9
/// times the larger of `tick_s` and `end_s`. If `end_s` does not exceed the tolerance, the result is 0. So
/// 0.7 s are 7 ticks of 0.1 s, although neither number is exact in binary. `tick_s` must be above 0.
std::uint64_t ticks_until(double end_s, double tick_s);

}  // namespace troupe::engine
