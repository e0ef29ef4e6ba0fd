#include "engine/spec/ticks.hpp"

#include <algorithm>

namespace troupe::engine {
namespace {

/// Bound on the rounding error of a number of ticks that is the quotient of two times.
double tolerance_of(double quotient) { return std::min(1e-9 * std::max(1.0, quotient), 0.5); }

}  // namespace

std::uint64_t ticks_until(double end_s, double tick_s) {
  const double quotient = end_s / tick_s;
  if (quotient >= static_cast<double>(k_most_ticks)) return k_most_ticks;
  const double ticks = quotient - tolerance_of(quotient);
  if (!(ticks > 0)) return 0;
  const auto whole = static_cast<std::uint64_t>(ticks);
  return static_cast<double>(whole) < ticks ? whole + 1 : whole;
}

std::uint64_t ticks_within(double time_s, double tick_s) {
  const double quotient = time_s / tick_s;
  if (quotient >= static_cast<double>(k_most_ticks)) return k_most_ticks;
  return quotient > 0 ? static_cast<std::uint64_t>(quotient + tolerance_of(quotient)) : 0;
}

std::uint64_t period_ticks(double period_s, double tick_s) {
  return std::max<std::uint64_t>(1, ticks_until(period_s, tick_s));
}

}  // namespace troupe::engine
