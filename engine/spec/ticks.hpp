#pragma once

#include <cstdint>

namespace troupe::engine {

/// Longest time or interval that a world file or an option may give, s, except the length of a run. A tick is
/// a time step of a world. The number of ticks in a time of this length fits 64 bits.
inline constexpr double k_most_seconds = 1e9;
/// Longest run, s: 32,000 years. A longer time is a mistake. In microseconds, the shortest ticks, it still
/// fits 64 bits.
inline constexpr double k_longest_run_s = 1e12;

/// Largest number of a tick: far more ticks than any run has, and exact in a double.
inline constexpr std::uint64_t k_most_ticks = 1'000'000'000'000'000;

/// Converts a period from seconds to ticks. A tick is a time step of the length `tick_s`, s, which must be
/// above 0. The result is rounded up to a whole number, as in the simulator Stage, but with the tolerance of
/// ticks_until() for rounding errors. It is at least 1 (also for 0, negative numbers and NaN) and at most
/// k_most_ticks.
std::uint64_t period_ticks(double period_s, double tick_s);

/// Returns the number of the first tick that ends at the simulated time `end_s`, s, or later. Ticks are time
/// steps of the length `tick_s`, s, counted from 1: tick n ends at n * tick_s. `tick_s` must be above 0.
///
/// A tick that ends slightly before `end_s` counts as well. The tolerance is 1e-9 times the larger of
/// `tick_s` and `end_s`, but at most half a tick. So 0.07 s is 7 ticks of 0.01 s, although 0.07 / 0.01 is
/// slightly above 7 in floating point. The result is 0 if `end_s` is NaN or at most the tolerance, and never
/// more than k_most_ticks.
std::uint64_t ticks_until(double end_s, double tick_s);

/// Returns the number of whole ticks in the duration `time_s`, s, rounded down, but with the tolerance of
/// ticks_until() for rounding errors: 0.3 s contains 3 ticks of 0.1 s, although 0.3 / 0.1 is slightly below 3
/// in floating point. `tick_s` must be above 0. The result is 0 if `time_s` is NaN or negative, and never
/// more than k_most_ticks.
std::uint64_t ticks_within(double time_s, double tick_s);

}  // namespace troupe::engine
