#pragma once

#include <cstdio>
#include <cstdlib>

/// TROUPE_ASSERT states an invariant of ours, never a property of the input. It is on in the Debug and check
/// builds (TROUPE_ASSERTIONS) and compiles to nothing elsewhere.
#ifdef TROUPE_ASSERTIONS
#define TROUPE_ASSERT(condition)                                                             \
  do {                                                                                       \
    if (!(condition)) {                                                                      \
      std::fprintf(stderr, "%s:%d: assertion failed: %s\n", __FILE__, __LINE__, #condition); \
      std::abort();                                                                          \
    }                                                                                        \
  } while (false)
#else
#define TROUPE_ASSERT(condition) static_cast<void>(sizeof(!(condition)))
#endif

#ifdef __FAST_MATH__
#error "Troupe promises the same bits everywhere; it cannot be compiled with -ffast-math"
#endif
