#include "base/fp_environment.hpp"

#include <cfenv>

// The functions below test results of arithmetic instead of reading a control register, so that they work on
// every processor. The volatile variables keep the compiler from computing the results at compile time.

namespace troupe {
namespace {

bool rounds_to_nearest() {
  const volatile double one = 1.0;
  const volatile double above = 0x1p-53;         // half the step above 1: a tie, which goes to the even 1
  const volatile double above_half = 0x1.8p-53;  // three quarters of the step above 1
  const volatile double below = 0x1p-54;         // half the step below 1
  const volatile double up_tie = one + above;
  const volatile double up = one + above_half;
  const volatile double down_tie = one - below;
  return up_tie == 1.0 && up == 0x1.0000000000001p0 && down_tie == 1.0;
}

bool keeps_denormal_results() {
  const volatile double smallest_normal = 0x1p-1022;
  const volatile double half = 0.5;
  const volatile double denormal = smallest_normal * half;
  // The result is scaled back up, because a comparison with zero may itself read denormals as zero.
  const volatile double back = denormal * 0x1p100;
  return back == 0x1p-923;
}

bool reads_denormals() {
  const volatile double denormal = 0x1p-1050;
  const volatile double scaled = denormal * 0x1p100;
  return scaled == 0x1p-950;
}

}  // namespace

Result<> check_fp_environment() {
  std::string wrong;
  const auto add = [&wrong](const char* text) {
    if (!wrong.empty()) wrong += ", ";
    wrong += text;
  };
  if (!rounds_to_nearest()) add("rounding is not to nearest");
  if (!reads_denormals())
    add("denormal operands are read as zero");
  else if (!keeps_denormal_results())
    add("denormal results are flushed to zero");
  if (!wrong.empty()) return Error{wrong};
  return {};
}

void restore_fp_environment() { std::fesetenv(FE_DFL_ENV); }

}  // namespace troupe
