#include "base/exact_sum.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace troupe {
namespace {

constexpr std::int64_t k_low_bits = 0xffffffff;
constexpr int k_mantissa_bits = 53;

}  // namespace

void ExactSum::add(double term) {
  const auto bits = std::bit_cast<std::uint64_t>(term);
  const auto exponent = static_cast<std::uint32_t>(bits >> 52 & 0x7ff);
  if (exponent == 0x7ff) {
    special_ += term;
    return;
  }
  std::uint64_t mantissa = bits & ((std::uint64_t{1} << 52) - 1);
  if (exponent != 0) mantissa |= std::uint64_t{1} << 52;
  // The term is mantissa * 2^shift units. A denormal has the exponent field 0 but the units of exponent 1.
  const std::uint32_t shift = std::max(exponent, 1u) - 1;
  const std::uint32_t within = shift % 32;
  const std::uint64_t low = mantissa << within;
  const std::uint64_t high = within == 0 ? 0 : mantissa >> (64 - within);
  const std::int64_t sign = bits >> 63 == 0 ? 1 : -1;
  std::int64_t* const limb = limbs_.data() + shift / 32;
  limb[0] += sign * static_cast<std::int64_t>(low & k_low_bits);
  limb[1] += sign * static_cast<std::int64_t>(low >> 32);
  limb[2] += sign * static_cast<std::int64_t>(high);
  if (++adds_ == k_most_adds) {
    carry(limbs_);
    adds_ = 0;
  }
}

void ExactSum::add(const ExactSum& other) {
  Limbs theirs = other.limbs_;
  carry(theirs);
  carry(limbs_);
  for (std::size_t i = 0; i < k_limbs; ++i) limbs_[i] += theirs[i];
  adds_ = 1;
  special_ += other.special_;
}

/// Moves the carry of each limb into the next one. Afterwards every limb except the last lies in
/// [0, 2^32 - 1], and the last one has the sign of the sum.
void ExactSum::carry(Limbs& limbs) {
  for (std::size_t i = 0; i + 1 < k_limbs; ++i) {
    limbs[i + 1] += limbs[i] >> 32;  // rounds down, also below 0
    limbs[i] &= k_low_bits;
  }
}

double ExactSum::value() const {
  if (special_ != 0) return special_;
  Limbs limbs = limbs_;
  carry(limbs);
  const bool is_negative = limbs.back() < 0;
  if (is_negative) {
    for (std::int64_t& limb : limbs) limb = -limb;
    carry(limbs);
  }
  std::size_t top = k_limbs - 1;
  while (top > 0 && limbs[top] == 0) --top;
  const auto bit = [&](std::size_t i) { return static_cast<std::uint64_t>(limbs[i / 32]) >> i % 32 & 1; };
  // The sum has `length` bits. The lowest `dropped` of them are rounded away.
  const std::size_t length =
      32 * top + static_cast<std::size_t>(std::bit_width(static_cast<std::uint64_t>(limbs[top])));
  const std::size_t dropped = length > k_mantissa_bits ? length - k_mantissa_bits : 0;
  std::uint64_t mantissa = 0;
  for (std::size_t i = length; i > dropped; --i) mantissa = mantissa << 1 | bit(i - 1);
  if (dropped > 0 && bit(dropped - 1) != 0) {
    bool is_tie = true;
    for (std::size_t i = 0; i + 1 < dropped && is_tie; ++i) is_tie = bit(i) == 0;
    if (!is_tie || mantissa % 2 != 0) ++mantissa;
  }
  // The exponent field of a normal number is dropped + 1. The 1 comes from the mantissa: its leading bit, the
  // 53rd, overflows into the exponent field.
  const std::uint64_t magnitude = (static_cast<std::uint64_t>(dropped) << 52) + mantissa;
  constexpr auto k_infinity = std::bit_cast<std::uint64_t>(std::numeric_limits<double>::infinity());
  const std::uint64_t sign = is_negative ? std::uint64_t{1} << 63 : 0;
  return std::bit_cast<double>(std::min(magnitude, k_infinity) | sign);
}

}  // namespace troupe
