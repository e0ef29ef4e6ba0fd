#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>

namespace troupe::test {

/// Random numbers for tests. The numbers for a seed are the same with every standard library. Therefore the
/// class computes them itself from the output of std::mt19937_64, which the C++ standard specifies, and uses
/// no std:: distributions, whose results the standard leaves open.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : words_(seed) {}

  /// Returns a random number, uniform in [low, high].
  double real(double low, double high) {
    return low + (high - low) * static_cast<double>(words_() >> 11) * 0x1p-53;
  }
  /// Returns a random number between `low` and `high`, uniform on a logarithmic scale. Both limits must be
  /// positive.
  double scale(double low, double high) { return std::exp(real(std::log(low), std::log(high))); }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(words_() % n); }  ///< 0 to n - 1
  bool chance(double p) { return real(0, 1) < p; }  ///< true with probability p

 private:
  std::mt19937_64 words_;
};

}  // namespace troupe::test
