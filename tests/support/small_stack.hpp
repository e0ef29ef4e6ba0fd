#pragma once

#include "tests/support/slow_build.hpp"

#include <gtest/gtest.h>
#include <pthread.h>

#include <cstddef>
#include <functional>

namespace troupe::test {

/// Calls a function on a thread with a stack of 64 kB. Skips the test in slow builds, whose functions need
/// more of the stack.
inline void on_small_stack(std::function<void()> call) {
  if (k_slow_build) GTEST_SKIP() << "without optimisation, or with a sanitizer, functions need more stack";
  constexpr std::size_t k_bytes = 64 * 1024;
  pthread_attr_t attributes{};
  ASSERT_EQ(pthread_attr_init(&attributes), 0);
  ASSERT_EQ(pthread_attr_setstacksize(&attributes, k_bytes), 0);
  pthread_t thread{};
  const auto run = [](void* function) -> void* {
    (*static_cast<std::function<void()>*>(function))();
    return nullptr;
  };
  ASSERT_EQ(pthread_create(&thread, &attributes, run, &call), 0);
  pthread_join(thread, nullptr);
  pthread_attr_destroy(&attributes);
}

}  // namespace troupe::test
