#pragma once

#include "partition/simd_target.hpp"

#include <string>

namespace troupe {

/// Calls test(name) once for each instruction set that is compiled in and that this processor supports,
/// portable code included. During the call, the kernels (vectorised loops) use the instruction set `name`.
/// Then restores the instruction set that was used before.
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
