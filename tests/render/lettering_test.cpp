#include "render/lettering.hpp"

#include <gtest/gtest.h>

#include <string>

namespace troupe::render::lettering_test {
namespace {

Lines written(std::string_view text) {
  Lines lines;
  add_text(lines, text, {0, 0}, 1);
  return lines;
}

TEST(Lettering, EveryPrintableCharacterHasAShapeOfItsOwn) {
  const Lines box = written("\x01");
  for (char c = '!'; c <= '~'; ++c) {
    const Lines shape = written(std::string(1, c));
    EXPECT_FALSE(shape.empty()) << c;
    EXPECT_FALSE(shape == box) << c;
    for (char other = '!'; other < c; ++other) {
      if (c == 'O' && other == '0') continue;
      EXPECT_FALSE(shape == written(std::string(1, other))) << c << other;
    }
  }
  EXPECT_TRUE(written(" ").empty());
}

TEST(Lettering, LettersStayWithinTheirHeightAndWidth) {
  for (char c = '!'; c <= '~'; ++c) {
    for (const auto& [a, b] : written(std::string(1, c))) {
      for (const Vec2& p : {a, b}) {
        EXPECT_GE(p.x(), 0) << c;
        EXPECT_LE(p.x(), text_width(std::string(1, c), 1) + 0.5) << c;
        EXPECT_GE(p.y(), -2) << c;
        EXPECT_LE(p.y(), 6) << c;
      }
    }
  }
}

TEST(Lettering, TextsGrowWithTheirUnit) {
  EXPECT_DOUBLE_EQ(text_width("robot", 3), 3 * text_width("robot", 1));
  EXPECT_GT(text_width("robots", 1), text_width("robot", 1));
  Lines lines;
  add_text(lines, "o", {10, 20}, 2);
  for (const auto& [a, b] : lines) {
    EXPECT_GE(a.x(), 10);
    EXPECT_GE(a.y(), 20);
    EXPECT_LE(b.y(), 32);
  }
}

TEST(Lettering, ALetterOfSeveralBytesIsOneBox) {
  EXPECT_EQ(written("\xc3\xa9").size(), 4U);  // e with an accent, in UTF-8
  EXPECT_DOUBLE_EQ(text_width("\xc3\xa9", 1), text_width("e", 1));
}

}  // namespace
}  // namespace troupe::render::lettering_test
