#include "base/bearings.hpp"

#include "base/math.hpp"
#include "base/random.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace troupe::bearings_test {
namespace {

TEST(Bearings, AreThoseOfAtan2InFloat) {
  Random random(1, 2, 3, 4);
  std::vector<Vec2> ways;
  for (int i = 0; i < 20000; ++i) {
    const double scale = exp(random.uniform(-20, 20));
    ways.emplace_back(scale * random.uniform(-1, 1), scale * random.uniform(-1, 1));
  }
  std::vector<float> bearings(ways.size());
  to_bearings(ways, bearings);
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const double angle = atan2(ways[i].y(), ways[i].x());
    // The error of the angle, and the rounding to float.
    EXPECT_NEAR(bearings[i], angle, 3e-9 + 0x1p-24 * std::abs(angle)) << ways[i].transpose();
  }
}

TEST(Bearings, OnTheAxes) {
  const std::array ways{Vec2(0, 0),  Vec2(1, 0),  Vec2(1, -0.0), Vec2(0, 2),
                        Vec2(-3, 0), Vec2(0, -4), Vec2(5, 5)};
  std::array<float, ways.size()> bearings{};
  to_bearings(ways, bearings);
  const auto pi = static_cast<float>(k_pi);
  const std::array<float, ways.size()> want{0, 0, 0, pi / 2, pi, -pi / 2, pi / 4};
  EXPECT_EQ(bearings, want);
  EXPECT_FALSE(std::signbit(bearings[2]));  // never -0
}

// The angles are hashed: these bits must never change.
TEST(Bearings, HaveTheirBits) {
  std::vector<Vec2> ways;
  for (int i = -30; i <= 30; ++i)
    for (int k = -30; k <= 30; ++k) ways.emplace_back(0.37 * i, 0.11 * k);
  std::vector<float> bearings(ways.size());
  to_bearings(ways, bearings);
  std::uint64_t sum = 0;
  for (const float bearing : bearings) sum = mix(sum, std::bit_cast<std::uint32_t>(bearing));
  EXPECT_EQ(sum, 0x44039d5d1cd1de20u);
}

}  // namespace
}  // namespace troupe::bearings_test
