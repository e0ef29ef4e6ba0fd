#include "tests/support/paths.hpp"
#include "worldio/colors.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace troupe::worldio::stage_colors_test {
namespace {

Color rgb(int r, int g, int b) {
  const auto part = [](int x) { return static_cast<float>(x) / 255.0f; };
  return {part(r), part(g), part(b), 1};
}

TEST(StageColors, NamesThatWorldsUse) {
  EXPECT_EQ(color_by_name("red"), rgb(255, 0, 0));
  EXPECT_EQ(color_by_name("green"), rgb(0, 255, 0));
  EXPECT_EQ(color_by_name("purple"), rgb(160, 32, 240));
  EXPECT_EQ(color_by_name("gray"), rgb(190, 190, 190));
  EXPECT_EQ(color_by_name("gray30"), rgb(77, 77, 77));
  EXPECT_EQ(color_by_name("gray50"), rgb(127, 127, 127));
  EXPECT_EQ(color_by_name("NavyBlue"), rgb(0, 0, 128));
  EXPECT_EQ(color_by_name("dark slate grey"), color_by_name("DarkSlateGray"));
}

TEST(StageColors, OtherWordsAreNoNames) {
  for (const char* word : {"", " ", "Red", "rde", "gray101", "gray007", "grayx", "snow0", "snow5", "snow1x",
                           "random", "DARKBLUE", "4", "gray99999999999"})
    EXPECT_FALSE(color_by_name(word)) << word;
}

TEST(StageColors, SuggestionsAreNames) {
  for (const std::string_view name : color_names()) EXPECT_TRUE(color_by_name(name)) << name;
}

TEST(StageColors, NamesAreThoseOfCss) {
  std::ifstream in(test::source_dir().string() + "/tests/worldio/css_colors.txt");
  std::size_t names = 0;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream fields(line);
    std::string name;
    int r = 0, g = 0, b = 0;
    ASSERT_TRUE(fields >> name >> r >> g >> b) << line;
    EXPECT_EQ(color_by_name(name), rgb(r, g, b)) << name;
    ++names;
  }
  EXPECT_EQ(names, 128u);
  // What CSS has otherwise, or not at all.
  EXPECT_EQ(color_by_name("maroon"), rgb(176, 48, 96));
  EXPECT_EQ(color_by_name("LightSlateBlue"), rgb(132, 112, 255));
  EXPECT_EQ(color_by_name("LightGoldenrod"), rgb(238, 221, 130));
  EXPECT_EQ(color_by_name("VioletRed"), rgb(208, 32, 144));
}

// X11's numbered shades are the first at 93.2, 80.4 and 54.8 % of its brightness, but for those of HotPink.
TEST(StageColors, ShadesAreDarkerByTheSameShares) {
  std::size_t shaded = 0;
  for (const std::string_view name : color_names()) {
    const auto first = color_by_name(std::string(name) + "1");
    if (!first || name == "HotPink" || name == "gray") continue;
    ++shaded;
    int number = 2;
    for (const float share : {0.932f, 0.804f, 0.548f}) {
      const auto shade = color_by_name(std::string(name) + std::to_string(number++));
      ASSERT_TRUE(shade) << name;
      for (const auto part : {&Color::r, &Color::g, &Color::b})
        EXPECT_NEAR(255 * (*shade.*part), 255 * share * (*first.*part), 1.5) << name << number - 1;
    }
  }
  EXPECT_EQ(shaded, 77u);
}

TEST(StageColors, GraysAreHundredths) {
  for (int percent = 0; percent <= 100; ++percent) {
    const auto gray = color_by_name("gray" + std::to_string(percent));
    ASSERT_TRUE(gray) << percent;
    EXPECT_NEAR(255 * gray->g, 2.55 * percent, 0.51) << percent;
    EXPECT_EQ(gray->r, gray->g);
    EXPECT_EQ(gray->b, gray->g);
  }
}

TEST(StageColors, EveryNameOfX11IsKnown) {
  const std::filesystem::path file = test::source_dir() / "../shared/stage-worlds/rgb.txt";
  std::ifstream in(file);
  if (!in) GTEST_SKIP() << "Stage's data are not in " << file;
  std::size_t names = 0;
  for (std::string line; std::getline(in, line);) {
    std::istringstream fields(line);
    int r = 0, g = 0, b = 0;
    std::string name;
    if (!(fields >> r >> g >> b >> std::ws) || !std::getline(fields, name)) continue;
    while (!name.empty() && (name.back() == ' ' || name.back() == '\t' || name.back() == '\r'))
      name.pop_back();
    EXPECT_EQ(color_by_name(name), rgb(r, g, b)) << name;
    ++names;
  }
  EXPECT_GT(names, 700u);
}

}  // namespace
}  // namespace troupe::worldio::stage_colors_test
