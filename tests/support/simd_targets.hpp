#pragma once

#include "partition/simd_target.hpp"

#include <string>

namespace troupe {

/// Calls test(name) with the kernels of each instruction set that this processor supports, including the
/// portable kernels.
template <class Test>
void for_each_simd_target(Test&& test) {
  const std::string before = partition::simd_target();
  for (const std::string& name : partition::simd_targets().usable) {
    partition::use_simd_target(name);
    test(name);
  }
  partition::use_simd_target(before);
}

}  // namespace troupe
