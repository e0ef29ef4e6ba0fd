#pragma once

#include <atomic>
#include <bit>
#include <cstdint>

namespace troupe {
namespace detail {

/// Atomically replaces `known` by `value` as long as is_better(value, known).
template <class T, class Better>
void replace_if(std::atomic<T>& known, T value, Better is_better) {
  T now = known.load(std::memory_order_relaxed);
  while (is_better(value, now) && !known.compare_exchange_weak(now, value, std::memory_order_relaxed)) {
  }
}

}  // namespace detail

/// Atomically raises a double to `value`, if `value` is greater. `most` holds the bits of the double;
/// value_of() returns the double. Both numbers must be non-negative, and neither may be -0 or NaN: the
/// function compares their bits as integers.
inline void raise_to(std::atomic<std::uint64_t>& most, double value) {
  detail::replace_if(most, std::bit_cast<std::uint64_t>(value),
                     [](std::uint64_t a, std::uint64_t b) { return a > b; });
}
/// Returns the double that raise_to() has raised.
inline double value_of(const std::atomic<std::uint64_t>& most) {
  return std::bit_cast<double>(most.load(std::memory_order_relaxed));
}

/// Atomically lowers a number to `value`, if `value` is smaller.
inline void lower_to(std::atomic<std::uint32_t>& least, std::uint32_t value) {
  detail::replace_if(least, value, [](std::uint32_t a, std::uint32_t b) { return a < b; });
}

}  // namespace troupe
