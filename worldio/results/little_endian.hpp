#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace troupe::worldio {

/// Reads a little-endian number of up to 8 bytes.
inline std::uint64_t little_endian(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8 | bytes[i];
  return value;
}

}  // namespace troupe::worldio
