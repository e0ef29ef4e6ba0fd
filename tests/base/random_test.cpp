#include "base/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

namespace troupe::random_test {
namespace {

using Words = std::array<std::uint32_t, 4>;

// The known answers published with Random123 1.09 (kat_vectors: philox4x32 10).
TEST(Philox, GivesThePublishedAnswers) {
  EXPECT_EQ(philox4x32({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox4x32({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
            (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Random, DrawsAreTheWordsOfTheirCounter) {
  Random random(0x299f31d0a4093822, 7, 8, 9);
  for (std::uint32_t k = 0; k < 3; ++k) {
    for (const std::uint32_t word : philox4x32({k, 7, 8, 9}, {0xa4093822, 0x299f31d0})) {
      EXPECT_EQ(random.bits(), word);
    }
  }
}

TEST(Random, EveryPartOfTheKeyChangesTheStream) {
  std::set<std::uint32_t> first;
  first.insert(Random(1, 2, 3, 4).bits());
  first.insert(Random(2, 2, 3, 4).bits());
  first.insert(Random((1ull << 32) + 1, 2, 3, 4).bits());
  first.insert(Random(1, 3, 3, 4).bits());
  first.insert(Random(1, 2, 4, 4).bits());
  first.insert(Random(1, 2, 3, 5).bits());
  EXPECT_EQ(first.size(), 6u);
}

TEST(Random, StreamIdsDependOnBothNamesAndTheirBorder) {
  EXPECT_NE(stream_id("ranger", "laser"), stream_id("ranger", "sonar"));
  EXPECT_NE(stream_id("ranger", "laser"), stream_id("fiducial", "laser"));
  EXPECT_NE(stream_id("ab", "c"), stream_id("a", "bc"));
  EXPECT_NE(stream_id("ab", ""), stream_id("", "ab"));
  EXPECT_EQ(stream_id("ranger", "laser"), 3740720014u);
}

TEST(Random, UniformFillsItsIntervalEvenly) {
  Random random(1, 1, 1, 1);
  constexpr int k_draws = 1'000'000;
  std::array<int, 100> bins{};
  double sum = 0;
  for (int i = 0; i < k_draws; ++i) {
    const double u = random.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    ++bins[static_cast<std::size_t>(u * 100)];
    sum += u;
  }
  EXPECT_NEAR(sum / k_draws, 0.5, 0.0015);  // 5 standard errors
  double chi_square = 0;
  for (const int n : bins) chi_square += (n - 10'000.0) * (n - 10'000.0) / 10'000.0;
  EXPECT_LT(chi_square, 170.0);  // 99 degrees of freedom: mean 99, standard deviation 14
  EXPECT_GT(chi_square, 45.0);
}

TEST(Random, UniformOfAnIntervalStaysBelowItsEnd) {
  Random random(1, 1, 1, 2);
  for (int i = 0; i < 100'000; ++i) {
    const double x = random.uniform(-2, 3);
    ASSERT_GE(x, -2.0);
    ASSERT_LT(x, 3.0);
    // An interval with two doubles in it, where half of the sums round up to the end.
    const double y = random.uniform(1.0, 0x1.0000000000001p0);
    ASSERT_EQ(y, 1.0);
  }
  EXPECT_EQ(random.uniform(5, 5), 5.0);
}

TEST(Random, BelowIsUnbiased) {
  Random random(1, 1, 1, 3);
  // Scaling 32 bits onto 3 x 2^30 results without drawing again would give every third one twice as often.
  constexpr std::uint32_t k_n = 3u << 30;
  std::array<int, 4> quarters{};
  std::array<int, 3> residues{};
  for (int i = 0; i < 400'000; ++i) {
    const std::uint32_t x = random.below(k_n);
    ASSERT_LT(x, k_n);
    ++quarters[x / (k_n / 4)];
    ++residues[x % 3];
  }
  for (const int n : quarters) EXPECT_NEAR(n, 100'000, 1'400);  // 5 standard deviations
  for (const int n : residues) EXPECT_NEAR(n, 133'333, 1'500);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(random.below(1), 0u);
}

TEST(Random, NormalHasItsMoments) {
  Random random(1, 1, 1, 4);
  constexpr int k_draws = 1'000'000;
  double sum = 0, squares = 0, fourths = 0;
  int beyond_two = 0;
  for (int i = 0; i < k_draws; ++i) {
    const double x = random.normal();
    ASSERT_TRUE(std::isfinite(x));
    sum += x;
    squares += x * x;
    fourths += x * x * x * x;
    beyond_two += std::fabs(x) > 2;
  }
  EXPECT_NEAR(sum / k_draws, 0, 0.005);
  EXPECT_NEAR(squares / k_draws, 1, 0.0075);
  EXPECT_NEAR(fourths / k_draws, 3, 0.05);
  EXPECT_NEAR(beyond_two, 45'500, 1'100);
}

TEST(Random, NormalUsesFourDraws) {
  Random a(1, 1, 1, 5);
  Random b(1, 1, 1, 5);
  a.normal();
  for (int i = 0; i < 4; ++i) b.bits();
  EXPECT_EQ(a.bits(), b.bits());
}

TEST(Random, ExponentialHasItsMoments) {
  Random random(1, 1, 1, 6);
  constexpr int k_draws = 1'000'000;
  double sum = 0, squares = 0;
  for (int i = 0; i < k_draws; ++i) {
    const double x = random.exponential();
    ASSERT_GE(x, 0.0);
    ASSERT_TRUE(std::isfinite(x));
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / k_draws, 1, 0.005);
  EXPECT_NEAR(squares / k_draws, 2, 0.025);
}

TEST(Random, ShuffleMakesEveryPermutationEquallyOften) {
  Random random(1, 1, 1, 7);
  std::array<int, 24> seen{};
  for (int i = 0; i < 240'000; ++i) {
    std::array<int, 4> items = {0, 1, 2, 3};
    random.shuffle(items);
    std::array<int, 4> sorted = items;
    std::sort(sorted.begin(), sorted.end());
    ASSERT_EQ(sorted, (std::array<int, 4>{0, 1, 2, 3}));
    std::size_t rank = 0;
    for (std::size_t j = 0; j < 4; ++j) {
      const auto smaller = std::count_if(items.begin() + static_cast<std::ptrdiff_t>(j) + 1, items.end(),
                                         [&](int x) { return x < items[j]; });
      rank = rank * (4 - j) + static_cast<std::size_t>(smaller);
    }
    ++seen[rank];
  }
  for (const int n : seen) EXPECT_NEAR(n, 10'000, 500);
}

TEST(Random, ShuffleTakesEmptyAndSingleSequences) {
  Random random(1, 1, 1, 8);
  std::vector<int> none;
  std::vector<int> one = {42};
  random.shuffle(none);
  random.shuffle(one);
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(one, std::vector<int>{42});
}

TEST(Mix, EveryInputBitFlipsHalfOfTheOutput) {
  Random random(1, 1, 1, 9);
  const auto word = [&random] {
    const std::uint64_t high = random.bits();
    return (high << 32) | random.bits();
  };
  for (int argument = 0; argument < 3; ++argument) {
    for (int bit = 0; bit < 64; ++bit) {
      int flipped = 0;
      for (int i = 0; i < 200; ++i) {
        std::array<std::uint64_t, 3> in = {word(), word(), word()};
        const std::uint64_t before = mix(in[0], in[1], in[2]);
        in[static_cast<std::size_t>(argument)] ^= 1ull << bit;
        flipped += std::popcount(before ^ mix(in[0], in[1], in[2]));
      }
      EXPECT_NEAR(flipped / 200.0, 32, 2) << "argument " << argument << ", bit " << bit;
    }
  }
}

TEST(Mix, SmallArgumentsDoNotCollide) {
  std::set<std::uint64_t> seen;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    for (std::uint64_t tick = 0; tick < 64; ++tick) {
      for (std::uint64_t id = 0; id < 64; ++id) seen.insert(mix(seed, tick, id));
    }
  }
  EXPECT_EQ(seen.size(), 8u * 64 * 64);
}

}  // namespace
}  // namespace troupe::random_test
