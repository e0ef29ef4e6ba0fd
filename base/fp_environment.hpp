#pragma once

#include "base/result.hpp"

namespace troupe {

/// Whether the calling thread computes as IEEE 754 asks (round to nearest, denormals kept); else what is
/// wrong. A library linked with -ffast-math by gcc switches flush-to-zero on for the thread that loads it.
Result<> check_fp_environment();

/// Restores round-to-nearest and denormals for the calling thread, and with them the rest of the default
/// environment: exceptions are masked and their flags cleared.
void restore_fp_environment();

}  // namespace troupe
