#pragma once

#include <atomic>
#include <bit>
#include <cstdint>

namespace troupe {

/// Atomically raises a double to `value`, if `value` is greater. `most` holds the bits of the double;
/// value_of() returns the double. Both numbers must be non-negative, and neither may be -0 or NaN: the
/// function compares their bits as integers.
inline void raise_to(std::atomic<std::uint64_t>& most, double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  std::uint64_t known = most.load(std::memory_order_relaxed);
  while (known < bits && !most.compare_exchange_weak(known, bits, std::memory_order_relaxed)) {
  }
}
inline double value_of(const std::atomic<std::uint64_t>& most) {
  return std::bit_cast<double>(most.load(std::memory_order_relaxed));
}

}  // namespace troupe
