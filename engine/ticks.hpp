#pragma once

#include <cstdint>

namespace troupe::engine {

/// Longest time or interval that worlds and options may give, s: its ticks can still be counted in 64 bits.
inline constexpr double k_most_seconds = 1e9;

/// Ticks between two runs of something with this period: as in Stage, the next multiple of the tick, and
/// every tick for 0. 0.3 s of 0.1 s ticks are 3, whatever their quotient rounds to.
std::uint64_t period_ticks(double period_s, double tick_s);

/// The first tick whose time is `end_s` or later; 0 for times before the start. 0.7 s of 0.1 s ticks are 7,
/// though neither is exact in binary: a billionth of a tick too early counts as in time.
std::uint64_t ticks_until(double end_s, double tick_s);

}  // namespace troupe::engine
