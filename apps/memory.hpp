#pragma once

#include <cstdint>

namespace troupe::apps {

/// Returns the size of the memory of this process that is in RAM, bytes; 0 if /proc/self/statm cannot be
/// read.
std::uint64_t resident_bytes();

}  // namespace troupe::apps
