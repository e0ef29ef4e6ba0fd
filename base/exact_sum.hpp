#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace troupe {

/// A sum of doubles without rounding errors. The result is the double nearest to the mathematical sum of all
/// terms, ties to even. The result does not depend on the order of the terms. Terms may be divided among
/// several ExactSum objects that are then added: this does not change the result either. A finite result
/// equals that of `math.fsum` in Python; for some finite results, however, `math.fsum` raises OverflowError.
///
/// source  The sum is kept as an integer, in units of the smallest double: Neal, Fast exact summation using
///         small and large superaccumulators, arXiv:1505.05571, 2015.
/// cost    about 5 ns per term
class ExactSum {
 public:
  /// Adds a term. If any term is NaN, or if there are infinities of both signs, the sum is NaN. If all
  /// infinities have the same sign, the sum is this infinity.
  void add(double term);
  /// Adds all terms of another sum.
  void add(const ExactSum& other);
  /// Returns the sum of all terms, rounded once: 0 without terms, infinite if the sum exceeds the largest
  /// double.
  double value() const;

 private:
  // The sum is the total of limbs_[i] * 2^(32 i), in units of 2^-1074, the smallest double. Limbs are signed
  // and have 64 bits, so neighbours overlap. A term adds less than 2^32 to each of three limbs, whose high
  // halves collect the carries. After k_most_adds terms, before a limb can overflow, carry() moves the
  // carries to the next limbs.
  static constexpr std::size_t k_limbs = 68;  // 2046 + 53 bits, and room for the carries of 2^64 terms
  static constexpr std::uint32_t k_most_adds = 1u << 30;

  using Limbs = std::array<std::int64_t, k_limbs>;
  static void carry(Limbs& limbs);

  Limbs limbs_{};
  std::uint32_t adds_ = 0;  // terms added since the last carry; another sum counts as one term
  double special_ = 0;      // sum of the infinities and NaNs among the terms
};

}  // namespace troupe
