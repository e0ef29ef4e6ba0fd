#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace troupe::partition {

/// The instruction sets that the kernels of the exact ray engine are compiled for. All of them compute the
/// same bits; they differ in speed alone. Named scalar (no vectors), ssse3, sse4, avx2, avx512 on x86-64;
/// scalar, neon, sve, sve2, sve_256, sve2_128 on Arm; others as Highway calls them, in lower case.
struct SimdTargets {
  std::vector<std::string> usable;   ///< compiled in, and this processor has them: the best first
  std::vector<std::string> missing;  ///< compiled in, but this processor lacks them
};
const SimdTargets& simd_targets();  ///< of this build, on this processor

/// The one that kernels run on, in the whole process: the best of the usable ones unless another was chosen.
std::string simd_target();

/// Has kernels run on this one from now on, in the whole process; not while a world is stepped. Throws
/// std::invalid_argument for one that is not usable here: `"avx512" is not an instruction set of this
/// processor; it has avx2, sse4, ssse3 and scalar`.
void use_simd_target(std::string_view name);

}  // namespace troupe::partition
