#pragma once

#include "base/result.hpp"

#include <string>

namespace troupe::test {

/// What went wrong; nothing where all is well. For EXPECT_EQ, which shows it.
template <class T>
std::string error_text(const Result<T>& result) {
  return result ? std::string() : result.error().text;
}

}  // namespace troupe::test
