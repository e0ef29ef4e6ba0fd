#pragma once

#include "base/result.hpp"

#include <string>

namespace troupe::test {

/// Returns the error text of a result; empty if there is no error. Use it with EXPECT_EQ, which prints the
/// text if the test fails.
template <class T>
std::string error_text(const Result<T>& result) {
  return result ? std::string() : result.error().text;
}

}  // namespace troupe::test
