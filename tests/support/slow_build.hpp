#pragma once

namespace troupe::test {

/// True in builds that are ten times slower or more: without optimisation, or with a sanitizer. In these
/// builds, tests of whole worlds simulate fewer robots or fewer ticks (time steps).
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
