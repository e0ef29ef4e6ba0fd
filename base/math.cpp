#include "base/math.hpp"

#include "base/assert.hpp"
#include "base/math_tables.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

// All functions use only IEEE + - x /, comparisons and bit operations. Odd functions remove the sign first
// and restore it last, so that f(-x) = -f(x) holds bit for bit, signed zeros included.

namespace troupe {
namespace {

using namespace math_tables;

constexpr double k_infinity = std::numeric_limits<double>::infinity();
constexpr std::uint64_t k_sign_bit = 1ull << 63;

std::uint64_t bits_of(double x) { return std::bit_cast<std::uint64_t>(x); }
double from_bits(std::uint64_t bits) { return std::bit_cast<double>(bits); }
std::uint64_t sign_of(double x) { return bits_of(x) & k_sign_bit; }
double magnitude(double x) { return from_bits(bits_of(x) & ~k_sign_bit); }
double with_sign(double x, std::uint64_t sign) { return from_bits(bits_of(x) ^ sign); }

/// 2^exponent, for exponents of normal numbers.
double power_of_two(int exponent) { return from_bits(static_cast<std::uint64_t>(exponent + 1023) << 52); }

/// An unevaluated sum: hi holds the leading bits, lo the remainder.
struct Sum {
  double hi;
  double lo;
};

/// a + b without error (Knuth, The Art of Computer Programming 2, 4.2.2).
Sum exact_sum(double a, double b) {
  const double sum = a + b;
  const double b_part = sum - a;
  return {sum, (a - (sum - b_part)) + (b - b_part)};
}

/// a x b without error, unless an intermediate result overflows or underflows (Dekker 1971, with Veltkamp's
/// splitting).
Sum exact_product(double a, double b) {
  constexpr double k_split = 134217729.0;  // 2^27 + 1
  const double a_big = k_split * a;
  const double a_hi = a_big - (a_big - a);
  const double a_lo = a - a_hi;
  const double b_big = k_split * b;
  const double b_hi = b_big - (b_big - b);
  const double b_lo = b - b_hi;
  const double product = a * b;
  return {product, ((a_hi * b_hi - product) + a_hi * b_lo + a_lo * b_hi) + a_lo * b_lo};
}

/// An integer as a double and as an std::int32_t.
struct Rounded {
  double value;
  std::int32_t integer;
};
/// The integer nearest to x, for |x| < 2^31. It is computed by adding 1.5 x 2^52: a double of that size has
/// no bits for a fraction, so the addition itself rounds.
Rounded nearest(double x) {
  constexpr double k_shift = 0x1.8p52;
  const double shifted = x + k_shift;
  return {shifted - k_shift, static_cast<std::int32_t>(static_cast<std::uint32_t>(bits_of(shifted)))};
}

// -- Angles --

/// Up to this angle, rad, the number n of quarter turns is below 2^20, so that the products of n with the
/// short parts of pi/2 are exact.
constexpr double k_near = 0x1p20;

/// angle - n * pi/2, for an n with which the difference is at most about pi. The first subtraction is exact;
/// exact_sum() keeps the rounding errors of the next two. Together the parts represent pi/2 to 2^-157.
Sum minus_half_pis(double angle, double n) {
  const double first = angle - n * k_half_pi_parts[0];
  const Sum second = exact_sum(first, -(n * k_half_pi_parts[1]));
  const Sum third = exact_sum(second.hi, -(n * k_half_pi_parts[2]));
  const double tail = second.lo + (third.lo - n * k_half_pi_parts[3]);
  const double hi = third.hi + tail;
  return {hi, (third.hi - hi) + tail};
}

/// An angle as quadrant * pi/2 + rest with |rest| <= pi/4; only the quadrant modulo 4 matters.
struct Reduced {
  Sum rest;
  std::uint32_t quadrant;
};

/// Reduces angles above k_near by the method of Payne and Hanek (1983): multiplies the angle's 53 bits by
/// binary digits of 2/pi, which gives the angle in quarter turns. Bits of the product worth 4 quarter turns
/// or more are whole turns and are not computed. 192 digits of 2/pi give an error of 2^-137; this suffices,
/// because a double is at least about 2^-61 away from every multiple of pi/2.
[[gnu::noinline]] Reduced reduce_far(double angle) {
  const std::uint64_t bits = bits_of(angle);
  const std::uint64_t mantissa = (bits & ((1ull << 52) - 1)) | (1ull << 52);
  const int exponent = static_cast<int>(bits >> 52) - 1075;  // angle = mantissa x 2^exponent

  // 192 digits of 2/pi, starting with the one worth 2^(1 - exponent). The lowest word is stored first.
  const unsigned first = static_cast<unsigned>(exponent + 62);
  std::array<std::uint64_t, 6> digits;
  for (unsigned i = 0; i < 6; ++i) {
    const std::uint32_t* word = k_two_over_pi_digits + first / 32 + i;
    const std::uint64_t pair = (static_cast<std::uint64_t>(word[0]) << 32) | word[1];
    digits[5 - i] = (pair << (first % 32)) >> 32;
  }

  // The product of the digits and the mantissa modulo 2^192, in units of 2^-190 quarter turns.
  std::array<std::uint64_t, 6> product{};
  const std::array<std::uint64_t, 2> factor = {mantissa & 0xffffffffu, mantissa >> 32};
  for (std::size_t j = 0; j < 2; ++j) {
    std::uint64_t carry = 0;
    for (std::size_t i = 0; i + j < 6; ++i) {
      const std::uint64_t t = product[i + j] + digits[i] * factor[j] + carry;
      product[i + j] = t & 0xffffffffu;
      carry = t >> 32;
    }
  }
  std::uint64_t high = (product[5] << 32) | product[4];
  std::uint64_t middle = (product[3] << 32) | product[2];
  std::uint64_t low = (product[1] << 32) | product[0];

  // The top two bits are the quadrant; the others are a fraction in two's complement, from -1/2 to 1/2.
  std::uint32_t quadrant = static_cast<std::uint32_t>(high >> 62);
  high = (high << 2) | (middle >> 62);
  middle = (middle << 2) | (low >> 62);
  low <<= 2;
  const bool negative = (high >> 63) != 0;
  if (negative) {
    ++quadrant;
    low = ~low + 1;
    middle = ~middle + (low == 0);
    high = ~high + (low == 0 && middle == 0);
  }
  const int zeros = std::countl_zero(high);
  TROUPE_ASSERT(zeros < 64);
  if (zeros > 0) {
    high = (high << zeros) | (middle >> (64 - zeros));
    middle = (middle << zeros) | (low >> (64 - zeros));
  }
  const double unit = power_of_two(-53 - zeros);
  const double fraction_hi = static_cast<double>(high >> 11) * unit;
  const double fraction_lo = static_cast<double>(((high & 0x7ff) << 42) | (middle >> 22)) * unit * 0x1p-53;

  const Sum product_hi = exact_product(fraction_hi, k_half_pi[0]);
  const double tail = product_hi.lo + (fraction_hi * k_half_pi[1] + fraction_lo * k_half_pi[0]);
  const double hi = product_hi.hi + tail;
  const double lo = (product_hi.hi - hi) + tail;
  return {negative ? Sum{-hi, -lo} : Sum{hi, lo}, quadrant & 3};
}

/// Sine and cosine of rest + quadrant * pi/2. Both polynomials are evaluated and swapped by masks: a
/// processor could not predict branches on the quadrant.
SinCos sincos_reduced(const Reduced& angle) {
  const double r = angle.rest.hi;
  const double z = r * r;
  const double z2 = z * z;
  const double half_z = 0.5 * z;
  const double one_less = 1.0 - half_z;

  const double sin_poly = (k_sin[0] + k_sin[1] * z) +
                          z2 * ((k_sin[2] + k_sin[3] * z) + z2 * ((k_sin[4] + k_sin[5] * z) + z2 * k_sin[6]));
  const double sine = r + (r * z * sin_poly + angle.rest.lo * one_less);

  const double cos_poly =
      (k_cos[0] + k_cos[1] * z) + z2 * ((k_cos[2] + k_cos[3] * z) + z2 * (k_cos[4] + k_cos[5] * z));
  const double cosine = one_less + (((1.0 - one_less) - half_z) + (z2 * cos_poly - r * angle.rest.lo));

  const std::uint64_t q = angle.quadrant;
  const std::uint64_t swap = (bits_of(sine) ^ bits_of(cosine)) & (0 - (q & 1));
  const std::uint64_t sin_sign = (q & 2) << 62;
  const std::uint64_t cos_sign = ((q + 1) & 2) << 62;
  return {from_bits((bits_of(sine) ^ swap) ^ sin_sign), from_bits((bits_of(cosine) ^ swap) ^ cos_sign)};
}

// -- atan2 --

/// base + atan(numerator / denominator) if `minus` is 0, and base - atan(numerator / denominator) if it is
/// the sign bit. Requires 0 <= numerator <= denominator and, because of exact_product(), a denominator from
/// 2^-400 to 2^400 and a numerator that is zero or at least 2^-400.
double atan_of_ratio(double numerator, double denominator, const Sum& base, std::uint64_t minus) {
  const double inverse = 1.0 / denominator;
  const double t = numerator / denominator;
  const Sum back = exact_product(t, denominator);
  const double t_lo = ((numerator - back.hi) - back.lo) * inverse;

  // atan(t) = atan(c) + atan((t - c) / (1 + c t)) with c = k/32. Below 3.5/32 c is 0, because only the
  // polynomial alone keeps the relative accuracy there. t - c is exact.
  const double* row = k_atan_table + 3 * nearest(32.0 * t).integer;
  const double shrink = 1.0 / (1.0 + row[0] * t);
  const double u = (t - row[0]) * shrink;
  const double z = u * u;
  const double z2 = z * z;
  const double poly = ((k_atan[0] + k_atan[1] * z) + z2 * (k_atan[2] + k_atan[3] * z)) +
                      (z2 * z2) * ((k_atan[4] + k_atan[5] * z) + z2 * (k_atan[6] + k_atan[7] * z));
  const double small = u + (t_lo * shrink + u * z * poly);

  const double table_hi = with_sign(row[1], minus);
  const double hi = base.hi + table_hi;
  const double lo = (table_hi - (hi - base.hi)) + (base.lo + with_sign(row[2], minus));
  return hi + (lo + with_sign(small, minus));
}

/// Does the same as atan_of_ratio() for arguments outside its domain. NaN, zeros, infinities and very small
/// ratios are special cases. Other arguments are scaled into the domain, which leaves the ratio unchanged.
[[gnu::noinline]] double atan_of_extreme_ratio(double numerator, double denominator, const Sum& base,
                                               std::uint64_t minus) {
  if (numerator != numerator || denominator != denominator) return k_nan;
  if (denominator == 0) return atan_of_ratio(0.0, 1.0, base, minus);
  if (denominator == k_infinity) return atan_of_ratio(numerator == k_infinity ? 1.0 : 0.0, 1.0, base, minus);
  // Below 2^-60 the arc tangent equals its argument, and the low part of a base no longer matters.
  const double ratio = numerator / denominator;
  if (ratio < 0x1p-60) return base.hi == 0 ? ratio : base.hi + with_sign(ratio, minus);
  const double scale = denominator < 1.0 ? 0x1p600 : 0x1p-600;
  return atan_of_ratio(numerator * scale, denominator * scale, base, minus);
}

inline SinCos sincos_near(double radians) {
  const double angle = magnitude(radians);
  const Rounded n = nearest(angle * k_two_over_pi);
  SinCos result = sincos_reduced({minus_half_pis(angle, n.value), static_cast<std::uint32_t>(n.integer) & 3});
  result.sin = with_sign(result.sin, sign_of(radians));
  return result;
}

}  // namespace

SinCos sincos(double radians) {
  const double angle = magnitude(radians);
  if (angle <= k_near) [[likely]]
    return sincos_near(radians);
  if (!(angle < k_infinity)) return {k_nan, k_nan};
  SinCos result = sincos_reduced(reduce_far(angle));
  result.sin = with_sign(result.sin, sign_of(radians));
  return result;
}

void sincos(std::span<const double> radians, std::span<SinCos> out) {
  TROUPE_ASSERT(radians.size() == out.size());
  bool near = true;
  for (const double angle : radians) near = near && magnitude(angle) <= k_near;
  if (near)
    for (std::size_t i = 0; i < radians.size(); ++i) out[i] = sincos_near(radians[i]);
  else
    for (std::size_t i = 0; i < radians.size(); ++i) out[i] = sincos(radians[i]);
}

// Eight rows are summed at a time, because within one row each addition must wait for the previous one.
void sum_rows(std::span<const double> values, std::size_t columns, std::span<double> sums) {
  TROUPE_ASSERT(values.size() == columns * sums.size());
  constexpr std::size_t k_some = 8;
  std::size_t row = 0;
  for (; row + k_some <= sums.size(); row += k_some) {
    double sum[k_some] = {};
    for (std::size_t c = 0; c < columns; ++c)
      for (std::size_t r = 0; r < k_some; ++r) sum[r] += values[(row + r) * columns + c];
    std::copy_n(sum, k_some, &sums[row]);
  }
  for (; row < sums.size(); ++row) {
    double sum = 0;
    for (std::size_t c = 0; c < columns; ++c) sum += values[row * columns + c];
    sums[row] = sum;
  }
}

double sin(double radians) { return sincos(radians).sin; }

double cos(double radians) { return sincos(radians).cos; }

double wrap_angle(double radians) {
  const double angle = magnitude(radians);
  if (angle <= k_pi) return radians;
  double wrapped;
  if (angle <= k_near) [[likely]] {
    wrapped = minus_half_pis(angle, 4.0 * nearest(angle * k_one_over_two_pi).value).hi;
  } else if (angle < k_infinity) {
    const Reduced reduced = reduce_far(angle);
    double quarters = static_cast<double>(reduced.quadrant);
    if (quarters == 3 || (quarters == 2 && reduced.rest.hi > 0)) quarters -= 4;
    const Sum sum = exact_sum(quarters * k_half_pi[0], reduced.rest.hi);
    wrapped = sum.hi + (sum.lo + (quarters * k_half_pi[1] + reduced.rest.lo));
  } else {
    return k_nan;
  }
  if (wrapped > k_pi) wrapped = k_pi;
  if (wrapped < -k_pi) wrapped = -k_pi;
  return with_sign(wrapped, sign_of(radians));
}

double atan2(double y, double x) {
  const double ay = magnitude(y);
  const double ax = magnitude(x);
  const bool steep = ay > ax;
  const double numerator = steep ? ax : ay;
  const double denominator = steep ? ay : ax;
  const std::uint64_t x_sign = sign_of(x);

  // With a = atan(numerator / denominator), the angle of (x, |y|) is 0 + a or pi/2 - a to the right of the y
  // axis, and pi - a or pi/2 + a to the left of it.
  const double quarters = steep ? 1.0 : (x_sign != 0 ? 2.0 : 0.0);
  const Sum base = {quarters * k_half_pi[0], quarters * k_half_pi[1]};
  const std::uint64_t minus = steep ? x_sign ^ k_sign_bit : x_sign;

  const bool plain =
      denominator >= 0x1p-400 && denominator <= 0x1p400 && (numerator >= 0x1p-400 || numerator == 0);
  const double angle = plain ? atan_of_ratio(numerator, denominator, base, minus)
                             : atan_of_extreme_ratio(numerator, denominator, base, minus);
  return with_sign(angle, sign_of(y));
}

double exp(double x) {
  if (!(x > -746.0 && x < 710.0)) [[unlikely]] {
    if (x != x) return k_nan;
    return x > 0 ? k_infinity : 0.0;
  }
  // With x = n ln(2)/32 + r: exp(x) = 2^floor(n / 32) * 2^((n mod 32) / 32) * exp(r).
  const Rounded n = nearest(x * k_32_over_ln2);
  const double r = (x - n.value * k_ln2_over_32_hi) - n.value * k_ln2_over_32_lo;
  const double z = r * r;
  const double poly = (k_exp[0] + k_exp[1] * r) + z * ((k_exp[2] + k_exp[3] * r) + z * k_exp[4]);
  const double* row = k_exp_table + 2 * (n.integer & 31);
  const double value = row[0] + (row[1] + row[0] * (r + z * poly));
  // 2^exponent is multiplied as two factors, because neither 2^1024 nor 2^-1075 is a double.
  const int exponent = n.integer >> 5;
  const int half = exponent >> 1;
  return value * power_of_two(half) * power_of_two(exponent - half);
}

double log(double x) {
  constexpr std::uint64_t k_smallest_normal = 1ull << 52;
  constexpr std::uint64_t k_infinity_bits = 0x7ffull << 52;
  std::uint64_t bits = bits_of(x);
  int exponent = 0;
  if (bits - k_smallest_normal >= k_infinity_bits - k_smallest_normal) [[unlikely]] {
    if (x == 0) return -k_infinity;
    if (!(x > 0)) return k_nan;
    if (x == k_infinity) return x;
    bits = bits_of(x * 0x1p54);
    exponent = -54;
  }
  // x = 2^exponent m with m in [0.6875, 1.375), so that logarithms near 0 are not the difference of two
  // larger numbers.
  constexpr std::uint64_t k_start = 0x3fe6000000000000;  // 0.6875
  const std::uint64_t offset = bits - k_start;
  const std::int64_t whole = static_cast<std::int64_t>(offset) >> 52;
  exponent += static_cast<int>(whole);
  const std::uint64_t m_bits = bits - (static_cast<std::uint64_t>(whole) << 52);
  const double* row = k_log_table + 3 * ((offset >> 45) & 127);

  // r = m c - 1 without error: c has 9 bits after the binary point, the upper part of m has 32.
  const double m_hi = from_bits(m_bits & ~((1ull << 21) - 1));
  const double m_lo = from_bits(m_bits) - m_hi;
  const Sum r = exact_sum(m_hi * row[0] - 1.0, m_lo * row[0]);

  const double x1 = r.hi;
  const double z = x1 * x1;
  const double poly = (k_log[0] + k_log[1] * x1) +
                      z * ((k_log[2] + k_log[3] * x1) + z * ((k_log[4] + k_log[5] * x1) + z * k_log[6]));
  const double e = static_cast<double>(exponent);
  const Sum sum = exact_sum(e * k_ln2_hi + row[1], x1);
  return sum.hi + (sum.lo + ((r.lo + (e * k_ln2_lo + row[2])) + z * (x1 * poly - 0.5)));
}

}  // namespace troupe
