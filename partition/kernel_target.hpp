#pragma once

#include <cstdint>

namespace troupe::partition {

/// The instruction set on which the kernels run (SimdTargets), as the library Highway numbers it: the value
/// of HWY_TARGET for which the version of the kernels that Highway chooses was compiled.
std::int64_t kernel_target();

}  // namespace troupe::partition
