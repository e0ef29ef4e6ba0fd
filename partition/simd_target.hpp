#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::partition {

/// The instruction sets that the kernels are compiled for. Kernels are the SIMD loops of the exact ray
/// engine, which computes where the beams of range sensors hit the outlines of bodies and walls. All
/// instruction sets give the same bits and differ only in speed. Their names are:
/// - on x86-64: scalar (no vectors), ssse3, sse4, avx2, avx512
/// - on Arm: scalar, neon, sve, sve2, sve_256, sve2_128
/// - on other processors: the names of the library Highway, in lower case
struct SimdTargets {
  std::vector<std::string> usable;   ///< compiled in and supported by this processor, the best first
  std::vector<std::string> missing;  ///< compiled in but not supported by this processor
};
const SimdTargets& simd_targets();  ///< the instruction sets of this build, on this processor

/// The instruction set that the kernels (see SimdTargets) of this process run on: the best usable one, unless
/// use_simd_target() has chosen another. Before an instruction set is used for the first time, its kernels
/// compute a small scene, which takes about 0.1 ms. If the results are wrong, the best instruction set with
/// right results is used instead. Throws std::runtime_error if there is none.
std::string simd_target();

/// The warning that simd_target() is not the best instruction set or the one that use_simd_target() has
/// chosen, because that one computes wrong results; empty if there is nothing to warn of. Loading a world
/// reports this warning (engine::World). Throws what simd_target() throws.
std::optional<std::string> simd_warning();

/// Makes the kernels (see SimdTargets) of the whole process run on this instruction set, unless it computes
/// wrong results (see simd_warning()). Do not call this function while the process computes a time step of a
/// simulation. name: one of simd_targets().usable. For any other name, the function throws
/// std::invalid_argument. The message lists the usable names, as in `"avx512" is not an instruction set of
/// this processor; this processor has avx2, sse4, ssse3 and scalar`.
void use_simd_target(std::string_view name);

}  // namespace troupe::partition
