#pragma once

#include <cstdio>
#include <cstdlib>

/// Checks an internal invariant. If `condition` is false, prints file, line and condition to standard error
/// and aborts. Invalid input must be reported as an error instead. The check is compiled only if the macro
/// TROUPE_ASSERTIONS is defined, as in the Debug build. Otherwise the condition is not evaluated.
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
#error "Troupe cannot be compiled with -ffast-math: its results must be bit-identical on every machine"
#endif
