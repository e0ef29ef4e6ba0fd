#include "base/result.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>

namespace troupe::result_test {
namespace {

Result<> check(int x) {
  if (x < 0) return Error{"is negative"};
  return {};
}

Result<std::unique_ptr<int>> make(int x) {
  if (const Result<> checked = check(x); !checked) return checked.error();
  return std::make_unique<int>(x);
}

TEST(Result, OfACheckIsTrueOrHasAnError) {
  EXPECT_TRUE(check(0));
  EXPECT_FALSE(check(-1));
  EXPECT_EQ(check(-1).error().text, "is negative");
  EXPECT_THROW(static_cast<void>(check(0).error()), std::bad_optional_access);
}

TEST(Result, HasAValueOrTheErrorOfTheCheckBeforeIt) {
  Result<std::unique_ptr<int>> made = make(7);
  ASSERT_TRUE(made);
  EXPECT_EQ(**made, 7);
  const std::unique_ptr<int> moved = *std::move(made);
  EXPECT_EQ(*moved, 7);
  EXPECT_FALSE(make(-7));
  EXPECT_EQ(make(-7).error().text, "is negative");
  EXPECT_THROW(static_cast<void>(*make(-7)), std::bad_variant_access);
  EXPECT_THROW(static_cast<void>(make(7).error()), std::bad_variant_access);
}

TEST(Result, AnEmptyTextIsAnErrorToo) {
  const Result<> result = Error{""};
  EXPECT_FALSE(result);
}

TEST(Result, IsNoNumberAndNoText) {
  EXPECT_FALSE((std::is_convertible_v<Result<>, bool>));
  EXPECT_FALSE((std::is_convertible_v<std::string, Result<>>));
  EXPECT_FALSE((std::is_convertible_v<std::string, Error>));
}

}  // namespace
}  // namespace troupe::result_test
