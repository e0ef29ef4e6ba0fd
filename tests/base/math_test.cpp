#include "base/math.hpp"

#include "base/hash.hpp"
#include "base/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

// The functions are compared with those of glibc for long double, whose error is about an ulp of long double:
// 1/2048 ulp of double.

namespace troupe::math_test {
namespace {

constexpr double k_inf = std::numeric_limits<double>::infinity();
constexpr double k_denormal = std::numeric_limits<double>::denorm_min();
constexpr double k_max = std::numeric_limits<double>::max();
constexpr int k_arguments = 1'000'000;

/// |got - expected| in units of the last place of a double of that size.
double ulps(double got, long double expected) {
  if (static_cast<long double>(got) == expected) return 0;
  if (!std::isfinite(got)) return k_inf;
  int exponent = 0;
  std::frexp(expected, &exponent);
  const long double ulp = std::ldexp(1.0L, std::max(exponent - 53, -1074));
  return static_cast<double>(std::fabs(static_cast<long double>(got) - expected) / ulp);
}

std::uint64_t bits_of(double x) { return std::bit_cast<std::uint64_t>(x); }

bool same_bits(double a, double b) { return bits_of(a) == bits_of(b); }

/// A random finite double; all exponents are equally likely.
double any_finite(Random& random) {
  for (;;) {
    const std::uint64_t high = random.bits();
    const double x = std::bit_cast<double>((high << 32) | random.bits());
    if (std::isfinite(x)) return x;
  }
}

/// The largest error of f, compared with `exact`, for arguments that draw() returns.
template <class Function, class Exact, class Draw>
double largest_error(Function f, Exact exact, Draw draw) {
  Random random(1, 2, 3, 4);
  double largest = 0;
  for (int i = 0; i < k_arguments; ++i) {
    const double x = draw(random);
    largest = std::max(largest, ulps(f(x), exact(static_cast<long double>(x))));
  }
  return largest;
}

const auto k_draw_heading = [](Random& random) { return random.uniform(-4, 4); };
const auto k_draw_near = [](Random& random) { return random.uniform(-1e6, 1e6); };
/// Around the multiples of pi/2, where the reduction cancels.
const auto k_draw_cancelling = [](Random& random) {
  return static_cast<double>(random.below(700'000)) * (k_pi / 2) * (1 + random.uniform(-4, 4) * 0x1p-52);
};

TEST(Math, SineIsWithinAnUlp) {
  const auto exact = [](long double x) { return std::sin(x); };
  EXPECT_LT(largest_error(sin, exact, k_draw_heading), 0.9);
  EXPECT_LT(largest_error(sin, exact, k_draw_near), 0.9);
  EXPECT_LT(largest_error(sin, exact, k_draw_cancelling), 0.9);
  EXPECT_LT(largest_error(sin, exact, any_finite), 0.9);
}

TEST(Math, CosineIsWithinAnUlp) {
  const auto exact = [](long double x) { return std::cos(x); };
  EXPECT_LT(largest_error(cos, exact, k_draw_heading), 0.9);
  EXPECT_LT(largest_error(cos, exact, k_draw_near), 0.9);
  EXPECT_LT(largest_error(cos, exact, k_draw_cancelling), 0.9);
  EXPECT_LT(largest_error(cos, exact, any_finite), 0.9);
}

TEST(Math, TheDoubleNearestToAMultipleOfHalfPiIsReducedRight) {
  // The closest any double comes: within 2^-60 of an odd multiple of pi/2 (Muller, Elementary Functions).
  const double x = std::ldexp(6381956970095103.0, 797);
  EXPECT_LT(std::fabs(cos(x)), 1e-17);
  EXPECT_LT(ulps(cos(x), std::cos(static_cast<long double>(x))), 0.9);
  EXPECT_EQ(std::fabs(sin(x)), 1.0);
}

TEST(Math, TheTwoReductionsMeet) {
  for (const double x :
       {0x1p20, std::nextafter(0x1p20, 0.0), std::nextafter(0x1p20, 2e6), 0x1.8p20, 0x1p31}) {
    EXPECT_LT(ulps(sin(x), std::sin(static_cast<long double>(x))), 0.9) << x;
    EXPECT_LT(ulps(cos(x), std::cos(static_cast<long double>(x))), 0.9) << x;
  }
}

TEST(Math, ArcTangentIsWithinAnUlp) {
  Random random(5, 6, 7, 8);
  const auto check = [](double y, double x) {
    return ulps(atan2(y, x), std::atan2(static_cast<long double>(y), static_cast<long double>(x)));
  };
  double largest = 0;
  for (int i = 0; i < k_arguments; ++i) {
    const double x = random.uniform(-10, 10);
    const double y = random.uniform(-10, 10);
    largest = std::max(largest, check(y, x));
    // Small and extreme ratios, down to denormal results.
    largest = std::max(largest, check(y * exp(random.uniform(-40, 0)), x));
    largest = std::max(largest, check(any_finite(random), any_finite(random)));
    // Near the ends of the table's intervals.
    const double ratio = (static_cast<double>(random.below(64)) / 64) * (1 + random.uniform(-4, 4) * 0x1p-52);
    largest = std::max(largest, check(ratio * x, x));
  }
  EXPECT_LT(largest, 0.9);
  for (const double scale : {0x1p-1070, 0x1p-500, 0x1p-400, 0x1p400, 0x1p500, 0x1p1020}) {
    EXPECT_LT(check(3 * scale, 2 * scale), 0.9) << scale;
    EXPECT_LT(check(2 * scale, -3 * scale), 0.9) << scale;
  }
}

TEST(Math, ExponentialIsWithinAnUlp) {
  const auto exact = [](long double x) { return std::exp(x); };
  EXPECT_LT(largest_error(exp, exact, [](Random& r) { return r.uniform(-1, 1); }), 0.6);
  EXPECT_LT(largest_error(exp, exact, [](Random& r) { return r.uniform(-708, 709.78); }), 0.6);
  // Results below the normal numbers are rounded twice.
  EXPECT_LT(largest_error(exp, exact, [](Random& r) { return r.uniform(-745.13, -708); }), 0.9);
}

TEST(Math, LogarithmIsWithinAnUlp) {
  const auto exact = [](long double x) { return std::log(x); };
  EXPECT_LT(largest_error(log, exact, [](Random& r) { return std::fabs(any_finite(r)) + k_denormal; }), 0.6);
  EXPECT_LT(largest_error(log, exact, [](Random& r) { return r.uniform(0.5, 2); }), 0.6);
  EXPECT_LT(largest_error(log, exact, [](Random& r) { return r.uniform(0.999, 1.001); }), 0.6);
  EXPECT_LT(largest_error(log, exact, [](Random& r) { return 0x1p-1030 * r.uniform(0.001, 1); }), 0.6);
}

TEST(Math, EdgesOfSineAndCosine) {
  EXPECT_TRUE(same_bits(sin(0.0), 0.0));
  EXPECT_TRUE(same_bits(sin(-0.0), -0.0));
  EXPECT_EQ(cos(0.0), 1.0);
  EXPECT_EQ(cos(-0.0), 1.0);
  EXPECT_EQ(sin(k_denormal), k_denormal);
  EXPECT_EQ(sin(1e-300), 1e-300);
  EXPECT_EQ(cos(1e-300), 1.0);
  for (const double x : {k_nan, k_inf, -k_inf}) {
    EXPECT_TRUE(std::isnan(sin(x)));
    EXPECT_TRUE(std::isnan(cos(x)));
  }
}

TEST(Math, EdgesOfArcTangentFollowIeee754) {
  const double half = k_pi / 2;
  EXPECT_TRUE(same_bits(atan2(0.0, 0.0), 0.0));
  EXPECT_TRUE(same_bits(atan2(-0.0, 0.0), -0.0));
  EXPECT_EQ(atan2(0.0, -0.0), k_pi);
  EXPECT_EQ(atan2(-0.0, -0.0), -k_pi);
  EXPECT_TRUE(same_bits(atan2(0.0, 3.0), 0.0));
  EXPECT_TRUE(same_bits(atan2(-0.0, 3.0), -0.0));
  EXPECT_EQ(atan2(0.0, -3.0), k_pi);
  EXPECT_EQ(atan2(-0.0, -3.0), -k_pi);
  EXPECT_EQ(atan2(2.0, 0.0), half);
  EXPECT_EQ(atan2(2.0, -0.0), half);
  EXPECT_EQ(atan2(-2.0, 0.0), -half);
  EXPECT_EQ(atan2(k_inf, 1.0), half);
  EXPECT_EQ(atan2(-k_inf, -1.0), -half);
  EXPECT_TRUE(same_bits(atan2(1.0, k_inf), 0.0));
  EXPECT_TRUE(same_bits(atan2(-1.0, k_inf), -0.0));
  EXPECT_EQ(atan2(1.0, -k_inf), k_pi);
  EXPECT_EQ(atan2(k_inf, k_inf), k_pi / 4);
  EXPECT_EQ(atan2(k_inf, -k_inf), 3 * (k_pi / 4));
  EXPECT_EQ(atan2(-k_inf, -k_inf), -3 * (k_pi / 4));
  EXPECT_EQ(atan2(k_denormal, 1.0), k_denormal);
  EXPECT_EQ(atan2(k_denormal, k_denormal), k_pi / 4);
  EXPECT_EQ(atan2(k_max, k_max), k_pi / 4);
  EXPECT_EQ(atan2(1e-300, 1e300), 0.0);
  EXPECT_EQ(atan2(1e-300, -1e300), k_pi);
  EXPECT_TRUE(std::isnan(atan2(k_nan, 1.0)));
  EXPECT_TRUE(std::isnan(atan2(1.0, k_nan)));
  EXPECT_TRUE(std::isnan(atan2(k_inf, k_nan)));
}

TEST(Math, EdgesOfExponentialAndLogarithm) {
  EXPECT_EQ(exp(0.0), 1.0);
  EXPECT_EQ(exp(-0.0), 1.0);
  EXPECT_EQ(exp(k_inf), k_inf);
  EXPECT_EQ(exp(-k_inf), 0.0);
  EXPECT_EQ(exp(709.79), k_inf);
  EXPECT_EQ(exp(1e300), k_inf);
  EXPECT_LT(exp(709.78), k_inf);
  EXPECT_EQ(exp(-745.2), 0.0);
  EXPECT_EQ(exp(-745.13), k_denormal);
  EXPECT_EQ(exp(-1e300), 0.0);
  EXPECT_TRUE(std::isnan(exp(k_nan)));

  EXPECT_TRUE(same_bits(log(1.0), 0.0));
  EXPECT_EQ(log(0.0), -k_inf);
  EXPECT_EQ(log(-0.0), -k_inf);
  EXPECT_EQ(log(k_inf), k_inf);
  EXPECT_TRUE(std::isnan(log(-1.0)));
  EXPECT_TRUE(std::isnan(log(-k_denormal)));
  EXPECT_TRUE(std::isnan(log(-k_inf)));
  EXPECT_TRUE(std::isnan(log(k_nan)));
}

TEST(Math, ManyAnglesAtOnceHaveTheBitsOfEach) {
  Random random(10, 0, 0, 0);
  for (const bool far : {false, true}) {
    for (std::size_t count : {0u, 1u, 2u, 3u, 64u, 255u, 10'000u}) {
      std::vector<double> angles;
      for (std::size_t i = 0; i < count; ++i)
        angles.push_back(far && i % 7 == 0 ? any_finite(random) : random.uniform(-4, 4));
      if (count > 2) angles[1] = -0.0;
      if (far && count > 2) angles[2] = k_nan;
      std::vector<SinCos> out(count);
      sincos(angles, out);
      for (std::size_t i = 0; i < count; ++i) {
        const SinCos each = sincos(angles[i]);
        ASSERT_TRUE(std::isnan(angles[i])
                        ? std::isnan(out[i].sin) && std::isnan(out[i].cos)
                        : same_bits(out[i].sin, each.sin) && same_bits(out[i].cos, each.cos))
            << angles[i];
      }
    }
  }
}

TEST(Math, SymmetriesHoldBitForBit) {
  Random random(9, 0, 0, 0);
  for (int i = 0; i < 100'000; ++i) {
    const double x = i % 2 == 0 ? any_finite(random) : random.uniform(-100, 100);
    const double y = i % 2 == 0 ? any_finite(random) : random.uniform(-100, 100);
    ASSERT_TRUE(same_bits(sin(-x), -sin(x))) << x;
    ASSERT_TRUE(same_bits(cos(-x), cos(x))) << x;
    ASSERT_TRUE(same_bits(atan2(-y, x), -atan2(y, x))) << y << ' ' << x;
    const SinCos both = sincos(x);
    ASSERT_TRUE(same_bits(both.sin, sin(x)) && same_bits(both.cos, cos(x))) << x;
    ASSERT_LE(std::fabs(both.sin), 1.0);
    ASSERT_LE(std::fabs(both.cos), 1.0);
    ASSERT_LE(std::fabs(atan2(y, x)), k_pi);
  }
}

TEST(Math, RisingFunctionsRise) {
  // An error below 1 ulp lets neighbours change places; arguments a few ulps of the result apart must not.
  Random random(10, 0, 0, 0);
  for (int i = 0; i < 100'000; ++i) {
    const double x = random.uniform(-700, 700);
    ASSERT_LT(exp(x), exp(x + 1e-14 * (1 + std::fabs(x)))) << x;
    const double t = random.uniform(-3, 3);
    ASSERT_LT(atan2(t, 1.0), atan2(t + 1e-14, 1.0)) << t;
    const double s = random.uniform(-1.5, 1.4999);
    ASSERT_LT(sin(s), sin(s + 1e-4)) << s;
    const double l = std::fabs(any_finite(random));
    if (l < 1e300 && l > 1e-300) {
      ASSERT_LT(log(l), log(l * (1 + 1e-12))) << l;
    }
  }
}

TEST(Math, InversesReturn) {
  Random random(11, 0, 0, 0);
  for (int i = 0; i < 100'000; ++i) {
    const double angle = random.uniform(-k_pi, k_pi);
    const SinCos s = sincos(angle);
    ASSERT_NEAR(s.sin * s.sin + s.cos * s.cos, 1.0, 5e-16);
    ASSERT_NEAR(atan2(s.sin, s.cos), angle, 1e-15 * 4);
    const double x = random.uniform(-700, 700);
    ASSERT_NEAR(log(exp(x)), x, 1e-12);
  }
}

TEST(WrapAngle, LeavesAnglesInsideAlone) {
  Random random(12, 0, 0, 0);
  for (int i = 0; i < 100'000; ++i) {
    const double x = random.uniform(-k_pi, k_pi);
    ASSERT_TRUE(same_bits(wrap_angle(x), x));
  }
  for (const double x : {0.0, -0.0, k_pi, -k_pi, k_denormal, -k_denormal}) {
    EXPECT_TRUE(same_bits(wrap_angle(x), x)) << x;
  }
}

TEST(WrapAngle, TakesTheNearestTurnOff) {
  // 2 pi in long doubles: the first part short enough for an exact product with 20 bits.
  const long double turn_hi = 0xc90fdaa221600000.p-61L;
  const long double turn_lo = 0x8c234c4c6628b80e.p-105L;
  ASSERT_NEAR(static_cast<double>(turn_hi + turn_lo), 2 * k_pi, 1e-15);
  Random random(13, 0, 0, 0);
  double largest = 0;
  for (int i = 0; i < k_arguments; ++i) {
    const double x = i % 2 == 0 ? random.uniform(-20, 20) : random.uniform(-1e6, 1e6);
    const double wrapped = wrap_angle(x);
    ASSERT_LE(std::fabs(wrapped), k_pi) << x;
    const long double n = std::nearbyint(static_cast<long double>(x) / (2 * std::numbers::pi_v<long double>));
    const long double expected = (x - n * turn_hi) - n * turn_lo;
    if (std::fabs(expected) < 1e-2L || std::fabs(expected) > std::numbers::pi_v<long double> - 1e-9L)
      continue;
    largest = std::max(largest, ulps(wrapped, expected));
  }
  EXPECT_LT(largest, 0.6);
  EXPECT_NEAR(wrap_angle(k_pi + 0.5), 0.5 - k_pi, 1e-15);
  EXPECT_NEAR(wrap_angle(-k_pi - 0.5), k_pi - 0.5, 1e-15);
  EXPECT_EQ(wrap_angle(std::nextafter(k_pi, 4.0)), -k_pi);
  EXPECT_EQ(wrap_angle(std::nextafter(-k_pi, -4.0)), k_pi);
}

TEST(WrapAngle, KeepsTheDirectionOfAnyAngle) {
  Random random(14, 0, 0, 0);
  for (int i = 0; i < 200'000; ++i) {
    const double x = i % 2 == 0 ? any_finite(random) : random.uniform(-1e9, 1e9);
    const double wrapped = wrap_angle(x);
    ASSERT_LE(std::fabs(wrapped), k_pi) << x;
    ASSERT_NEAR(sin(wrapped), sin(x), 5e-16) << x;
    ASSERT_NEAR(cos(wrapped), cos(x), 5e-16) << x;
    ASSERT_TRUE(same_bits(wrap_angle(-x), -wrapped)) << x;
  }
  for (const double x : {k_nan, k_inf, -k_inf}) EXPECT_TRUE(std::isnan(wrap_angle(x)));
}

TEST(Math, DegreesAndRadians) {
  EXPECT_EQ(radians(180.0), k_pi);
  EXPECT_EQ(degrees(k_pi), 180.0);
  EXPECT_EQ(radians(0.0), 0.0);
}

/// The bits of each function on half a million arguments of all kinds. The value was checked with gcc 12 and
/// clang 14, Debug and Release; a change of it changes every golden hash of the project.
TEST(Math, BitsAreTheSameEverywhere) {
  Random random(2008, 1, 2, 3);
  std::vector<double> values;
  for (int i = 0; i < 50'000; ++i) {
    const double a = i % 2 == 0 ? random.uniform(-10, 10) : any_finite(random);
    const double b = i % 2 == 0 ? random.uniform(-10, 10) : any_finite(random);
    const double near = random.uniform(-1e6, 1e6);
    const double exponent = random.uniform(-746, 710);
    const double positive = std::fabs(a);
    for (const double value : {sin(a), cos(a), sin(near), cos(near), atan2(a, b), exp(exponent), exp(a),
                               log(positive), wrap_angle(near), wrap_angle(a)}) {
      values.push_back(value);
    }
  }
  EXPECT_EQ(hex(hash_bytes(std::as_bytes(std::span(values)))), "1529330995fdd8f1");
}

TEST(SumRows, AddsTheTermsOfEachRowFromFirstToLast) {
  Random random(5, 0, 0, 0);
  for (const std::size_t rows : {0u, 1u, 7u, 8u, 9u, 20u})
    for (const std::size_t columns : {0u, 1u, 2u, 33u}) {
      std::vector<double> values(rows * columns);
      for (double& value : values) value = random.uniform(-1e9, 1e-9);
      std::vector<double> sums(rows, -1);
      sum_rows(values, columns, sums);
      for (std::size_t r = 0; r < rows; ++r)
        EXPECT_EQ(sums[r],
                  std::accumulate(values.data() + r * columns, values.data() + (r + 1) * columns, 0.0));
    }
}

}  // namespace
}  // namespace troupe::math_test
