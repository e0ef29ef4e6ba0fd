#pragma once

#include <cstdint>
#include <cstdlib>

#include "base/sanitizers.hpp"

namespace troupe::test {

/// True in builds that are ten times slower or more: without optimisation, or with a sanitizer. In these
/// builds, tests of whole worlds simulate fewer robots or fewer ticks (time steps).
#if !defined(__OPTIMIZE__) || defined(TROUPE_ADDRESS_SANITIZER) || defined(TROUPE_THREAD_SANITIZER)
inline constexpr bool k_slow_build = true;
#else
inline constexpr bool k_slow_build = false;
#endif

/// Number of seeds with which tests run a whole scene: 10 with `scripts/test --long`, otherwise 3.
inline std::uint64_t scene_seeds() { return std::getenv("TROUPE_LONG_TESTS") != nullptr ? 10 : 3; }

}  // namespace troupe::test
