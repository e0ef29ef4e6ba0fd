#pragma once

namespace troupe::test {

/// True in builds in which a step takes ten times as long or longer (without optimisation, or with a
/// sanitizer). In these builds, tests that run whole worlds run fewer robots or ticks.
#if !defined(__OPTIMIZE__) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool k_slow_build = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
inline constexpr bool k_slow_build = true;
#else
inline constexpr bool k_slow_build = false;
#endif
#else
inline constexpr bool k_slow_build = false;
#endif

}  // namespace troupe::test
