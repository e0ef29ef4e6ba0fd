#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace troupe::worldio {

/// Reads an unsigned little-endian number of at most 8 bytes; 0 if `bytes` is empty.
inline std::uint64_t little_endian(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8 | bytes[i];
  return value;
}

/// Writes a number as an unsigned little-endian number with as many bytes as the span has.
inline void put_little_endian(std::uint64_t value, std::span<std::uint8_t> bytes) {
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(value);
    value >>= 8;
  }
}

}  // namespace troupe::worldio
