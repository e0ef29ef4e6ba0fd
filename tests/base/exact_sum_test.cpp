#include "base/exact_sum.hpp"

#include "base/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace troupe::exact_sum_test {
namespace {

using Limits = std::numeric_limits<double>;

double sum(std::span<const double> terms) {
  ExactSum exact;
  for (const double term : terms) exact.add(term);
  return exact.value();
}
double sum(std::initializer_list<double> terms) { return sum(std::span(terms.begin(), terms.size())); }

/// The sum by another method: Shewchuk's expansions of doubles that do not overlap, rounded by adding them
/// from the largest down to the first inexact addition. For sums that do not overflow on the way.
double by_expansion(std::vector<double> terms) {
  std::vector<double> parts;
  for (double x : terms) {
    std::size_t kept = 0;
    for (double y : parts) {
      if (std::abs(x) < std::abs(y)) std::swap(x, y);
      const double high = x + y;
      const double low = y - (high - x);
      if (low != 0) parts[kept++] = low;
      x = high;
    }
    parts.resize(kept);
    parts.push_back(x);
  }
  double high = 0;
  while (!parts.empty()) {
    const double x = high;
    const double y = parts.back();
    parts.pop_back();
    high = x + y;
    const double low = y - (high - x);
    if (low == 0) continue;
    // The last addition has rounded a tie to even, although the remaining terms determine the direction.
    if (!parts.empty() && (low < 0) == (parts.back() < 0)) {
      const double twice = 2 * low;
      if (const double other = high + twice; other - high == twice) high = other;
    }
    break;
  }
  return high;
}

TEST(ExactSum, IsExactWhereASumOfDoublesIsNot) {
  EXPECT_EQ(sum({}), 0);
  EXPECT_EQ(sum({1e100, 1, -1e100}), 1);
  EXPECT_EQ(sum({0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1}), 1);
  EXPECT_EQ(sum({Limits::max(), Limits::max(), -Limits::max()}), Limits::max());
  EXPECT_EQ(sum({-3, 1e-300, 3}), 1e-300);
  EXPECT_EQ(sum({Limits::denorm_min(), Limits::denorm_min()}), 2 * Limits::denorm_min());
  EXPECT_EQ(sum({Limits::min(), -Limits::denorm_min()}), Limits::min() - Limits::denorm_min());
}

TEST(ExactSum, RoundsTiesToEven) {
  const double half = Limits::epsilon() / 2;
  EXPECT_EQ(sum({1, half}), 1);
  EXPECT_EQ(sum({1 + Limits::epsilon(), half}), 1 + 2 * Limits::epsilon());
  EXPECT_EQ(sum({1, half, Limits::denorm_min()}), 1 + Limits::epsilon());
  EXPECT_EQ(sum({-1, -half, -Limits::denorm_min()}), -1 - Limits::epsilon());
  EXPECT_EQ(sum({2, -half / 2}), 2) << "the spacing below 2 is smaller";
  EXPECT_EQ(sum({2 - Limits::epsilon(), half}), 2) << "the mantissa overflows into the exponent";
}

TEST(ExactSum, BeyondTheLargestDoubleIsInfinite) {
  EXPECT_EQ(sum({Limits::max(), Limits::max()}), Limits::infinity());
  EXPECT_EQ(sum({-Limits::max(), -Limits::max()}), -Limits::infinity());
  EXPECT_EQ(sum({Limits::infinity(), -1}), Limits::infinity());
  EXPECT_TRUE(std::isnan(sum({Limits::infinity(), 1, -Limits::infinity()})));
  EXPECT_TRUE(std::isnan(sum({1, Limits::quiet_NaN()})));
}

TEST(ExactSum, DependsNeitherOnTheOrderNorOnTheDivisionOfTheTerms) {
  Random random(1, 2, 3, 4);
  for (int round = 0; round < 2000; ++round) {
    std::vector<double> terms(1 + random.below(40));
    const std::uint32_t spread = 1 + random.below(500);  // range of the exponents
    for (double& term : terms) {
      const std::uint64_t exponent = 1023 - spread + random.below(2 * spread + 1);
      const std::uint64_t mantissa = static_cast<std::uint64_t>(random.uniform() * 0x1p52);
      term = std::bit_cast<double>(std::uint64_t{random.below(2)} << 63 | exponent << 52 | mantissa);
    }
    if (round % 2 == 0)  // most terms cancel each other
      for (std::size_t i = 0, n = terms.size(); i < n; ++i) terms.push_back(-terms[i] * (i == 0 ? 0.5 : 1));
    const double expected = by_expansion(terms);
    for (int permutation = 0; permutation < 4; ++permutation) {
      for (std::size_t i = terms.size(); i > 1; --i)
        std::swap(terms[i - 1], terms[random.below(static_cast<std::uint32_t>(i))]);
      ASSERT_EQ(sum(terms), expected) << round;
      ExactSum parts[3];
      for (const double term : terms) parts[random.below(3)].add(term);
      parts[1].add(parts[2]);
      parts[0].add(parts[1]);
      ASSERT_EQ(parts[0].value(), expected) << round;
    }
  }
}

TEST(ExactSum, OfManyEqualTerms) {
  ExactSum exact;
  for (int i = 0; i < 10'000'000; ++i) exact.add(0.1);
  EXPECT_EQ(exact.value(), 1e6) << "0.1 is slightly too large, by less than half a unit of the sum";
}

TEST(ExactSum, OfSumsOfMoreTermsThanAnyIntegerCounts) {
  for (const double term : {0.1, -0.1, Limits::denorm_min()}) {
    ExactSum exact;
    exact.add(term);
    for (int doublings = 0; doublings < 80; ++doublings) {
      const ExactSum same = exact;
      exact.add(same);
    }
    EXPECT_EQ(exact.value(), std::ldexp(term, 80));
  }
}

}  // namespace
}  // namespace troupe::exact_sum_test
