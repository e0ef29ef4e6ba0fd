#pragma once

#include <hwy/highway.h>

#include <string>

namespace troupe {

/// Runs test(name) with the kernels of each instruction set that this processor has, and with the portable
/// ones.
template <class Test>
void for_each_simd_target(Test&& test) {
  const auto run_with = [&](std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    test(std::string(hwy::TargetName(target)));
  };
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) run_with(target);
  run_with(HWY_EMU128);
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
}

}  // namespace troupe
