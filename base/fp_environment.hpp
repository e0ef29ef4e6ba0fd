#pragma once

#include "base/result.hpp"

namespace troupe {

/// Checks that the calling thread rounds to nearest and keeps denormals, as IEEE 754 requires. The error says
/// what is wrong. A library that gcc linked with -ffast-math enables flush-to-zero in the thread that loads
/// it.
Result<> check_fp_environment();

/// Restores the default floating-point environment of the calling thread: round to nearest, denormals kept,
/// exceptions masked and their flags cleared.
void restore_fp_environment();

}  // namespace troupe
