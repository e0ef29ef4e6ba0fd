#include "render/value_colors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace troupe::render::value_colors_test {
namespace {

int lightness(const Rgba& color) { return (299 * color[0] + 587 * color[1] + 114 * color[2]) / 1000; }

TEST(ValueColor, GrowsLighterAllTheWay) {
  for (int i = 1; i <= 100; ++i)
    EXPECT_GE(lightness(value_color(i / 100.0)), lightness(value_color((i - 1) / 100.0))) << i;
  EXPECT_GT(lightness(value_color(1)), lightness(value_color(0)) + 150);
}

TEST(ValueColor, BeyondTheEndsAreTheEnds) {
  EXPECT_EQ(value_color(-3), value_color(0));
  EXPECT_EQ(value_color(7), value_color(1));
}

TEST(ValueColors, GoFromTheLeastToTheMost) {
  const std::vector<double> values = {3, std::nan(""), 5, 4};
  const auto range = range_of(values);
  EXPECT_EQ(range, std::pair(3.0, 5.0));
  const std::vector<Rgba> colors = value_colors(values, range);
  ASSERT_EQ(colors.size(), 4U);
  EXPECT_EQ(colors[0], value_color(0));
  EXPECT_EQ(colors[1], k_no_value);
  EXPECT_EQ(colors[2], value_color(1));
  EXPECT_EQ(colors[3], value_color(0.5));
}

TEST(ValueColors, ARangeMayBeAsWideAsTheNumbers) {
  const double most = std::numeric_limits<double>::max();
  const std::vector<double> values = {-most, 0, most};
  EXPECT_EQ(value_colors(values, range_of(values)),
            (std::vector<Rgba>{value_color(0), value_color(0.5), value_color(1)}));
}

TEST(ValueColors, EqualValuesAndNoneHaveARangeToo) {
  EXPECT_EQ(range_of(std::vector<double>{2, 2}), std::pair(1.5, 2.5));
  EXPECT_EQ(range_of({}), std::pair(0.0, 1.0));
  EXPECT_EQ(range_of(std::vector<double>{std::nan(""), std::numeric_limits<double>::infinity()}),
            std::pair(0.0, 1.0));
}

}  // namespace
}  // namespace troupe::render::value_colors_test
