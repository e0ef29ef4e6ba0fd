#pragma once

#include <cstdio>
#include <cstdlib>

/// Checks an internal invariant. If `condition` is false, prints file, line and condition to standard error
/// and aborts. Do not use it for invalid input, which must be reported as an error. If the macro
/// TROUPE_ASSERTIONS is not defined, `condition` is not evaluated. The Debug build defines the macro.
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

// gcc defines all of these macros. clang has no macro for -fassociative-math and -freciprocal-math alone.
#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) || \
    (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error \
    "Troupe cannot be compiled with -ffast-math or a flag that it contains (-fassociative-math, \
-freciprocal-math, -ffinite-math-only): its results must be bit-identical on every machine"
#endif
