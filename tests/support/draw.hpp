#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>

namespace troupe::test {

/// Random numbers for tests. A seed gives the same numbers with every standard library: the standard defines the
/// words of std::mt19937_64, but not what its distributions make of them.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : words_(seed) {}

  /// Uniform in [low, high].
  double real(double low, double high) {
    return low + (high - low) * static_cast<double>(words_() >> 11) * 0x1p-53;
  }
  /// Uniform on a logarithmic scale, from `low` to `high`, both positive.
  double scale(double low, double high) { return std::exp(real(std::log(low), std::log(high))); }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(words_() % n); }  ///< 0 to n - 1
  bool chance(double p) { return real(0, 1) < p; }  ///< true with probability p

 private:
  std::mt19937_64 words_;
};

}  // namespace troupe::test
