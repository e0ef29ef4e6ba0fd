#include "base/number_text.hpp"

#include "base/geometry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

namespace troupe::number_text_test {
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

TEST(ExactNumber, ConvertsBackToTheSameNumber) {
  for (const double x : {3600.0000001, 100000.000001, -1 / 3.0, 1e-9, 1.234e-8, 0.1 + 0.2, 123456789012345.6,
                         1e15, 1e30, -5e-324, 1.7976931348623157e308})
    EXPECT_EQ(number_of<double>(exact_number(x)), x);
}

TEST(ExactNumber, IsShortAndHasAnExponentOnlyIfItIsExtreme) {
  EXPECT_EQ(exact_number(0), "0");
  EXPECT_EQ(exact_number(-2.5), "-2.5");
  EXPECT_EQ(exact_number(0.000001), "0.000001");
  EXPECT_EQ(exact_number(3600.0000001), "3600.0000001");
  EXPECT_EQ(exact_number(1e15), "1000000000000000");
  EXPECT_EQ(exact_number(-1.2345678901234567e-9), "-0.0000000012345678901234566");
  EXPECT_EQ(exact_number(1e30), "1e+30");
  EXPECT_EQ(exact_number(1e-12), "1e-12");
  EXPECT_EQ(exact_number(-std::numeric_limits<double>::infinity()), "-inf");
  EXPECT_EQ(exact_number(std::numeric_limits<double>::quiet_NaN()), "nan");
}

TEST(ExtentText, GivesBothAxesInPlainNumbers) {
  Box box;
  box.extend(Vec2(-2, 0.000001));
  box.extend(Vec2(3600, 5.5));
  EXPECT_EQ(extent_text(box), "x -2 to 3600, y 0.000001 to 5.5 m");
}

TEST(NumberOf, IsThatOfAWholeTextInRange) {
  EXPECT_EQ(number_of<double>("-2.5e-3"), -2.5e-3);
  EXPECT_EQ(number_of<std::uint8_t>("255"), 255);
  EXPECT_EQ(number_of<int>("-7"), -7);
  for (const char* text : {"", " 1", "1 ", "+1", "1m", "0x10", "1,5", "1e999", "--1", "e5"})
    EXPECT_EQ(number_of<double>(text), std::nullopt) << text;
  for (const char* text : {"256", "-1", "1.0", "1e2"})
    EXPECT_EQ(number_of<std::uint8_t>(text), std::nullopt) << text;
}

TEST(NumberOf, MayBeInfiniteUnlessItMustBeFinite) {
  EXPECT_EQ(number_of<double>("-inf"), -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(number_of<double>("nan").value()));
  for (const char* text : {"inf", "-inf", "nan", "1 "})
    EXPECT_EQ(finite_number_of(text), std::nullopt) << text;
  EXPECT_EQ(finite_number_of("1e308"), 1e308);
}

}  // namespace
}  // namespace troupe::number_text_test
