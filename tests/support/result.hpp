#pragma once

#include "base/result.hpp"

#include <string>

namespace troupe::test {

/// Returns the error text of a result; empty if there is no error. For EXPECT_EQ, which prints the text.
template <class T>
std::string error_text(const Result<T>& result) {
  return result ? std::string() : result.error().text;
}

}  // namespace troupe::test
