#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace troupe::test {

/// Returns the text of the exception of type `Exception` that call() throws. If call() throws nothing, the
/// test fails and the result is empty.
template <class Exception, class Call>
std::string message_of(Call&& call) {
  try {
    std::forward<Call>(call)();
  } catch (const Exception& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

}  // namespace troupe::test
