#pragma once

#include "base/result.hpp"

namespace troupe {

/// Checks that the calling thread rounds to nearest and keeps denormal numbers, as IEEE 754 requires.
/// Otherwise returns an error that says what is wrong, such as "denormal results are flushed to zero". The
/// usual cause is a library that gcc has linked with -ffast-math: a thread that loads such a library flushes
/// denormals to zero from then on.
Result<> check_fp_environment();

/// Restores the default floating-point environment of the calling thread: round to nearest, denormals kept,
/// exceptions masked and their flags cleared.
void restore_fp_environment();

}  // namespace troupe
