#include "base/number_text.hpp"

#include "base/geometry.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace troupe {
namespace {

TEST(PlainNumber, HasNoExponent) {
  EXPECT_EQ(plain_number(0), "0");
  EXPECT_EQ(plain_number(0.1), "0.1");
  EXPECT_EQ(plain_number(-2.5), "-2.5");
  EXPECT_EQ(plain_number(0.000001), "0.000001");
  EXPECT_EQ(plain_number(-0.00001234), "-0.00001234");
  EXPECT_EQ(plain_number(3600), "3600");
  EXPECT_EQ(plain_number(1e12), "1000000000000");
  EXPECT_EQ(plain_number(1e15), "1000000000000000");
}

TEST(PlainNumber, RoundsToItsDigits) {
  EXPECT_EQ(plain_number(0.1 + 0.2), "0.3");
  EXPECT_EQ(plain_number(123456, 4), "123456");
  EXPECT_EQ(plain_number(1.23456, 4), "1.235");
  EXPECT_EQ(plain_number(0.0000123456, 4), "0.00001235");
}

TEST(PlainNumber, HasAnExponentIfItIsExtreme) {
  EXPECT_EQ(plain_number(1e30), "1e+30");
  EXPECT_EQ(plain_number(1e-12), "1e-12");
  EXPECT_EQ(plain_number(std::numeric_limits<double>::infinity()), "inf");
}

TEST(ExtentText, GivesBothAxesInPlainNumbers) {
  Box box;
  box.extend(Vec2(-2, 0.000001));
  box.extend(Vec2(3600, 5.5));
  EXPECT_EQ(extent_text(box), "x -2 to 3600, y 0.000001 to 5.5 m");
}

}  // namespace
}  // namespace troupe
