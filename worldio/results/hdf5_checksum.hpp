#pragma once

#include <cstdint>
#include <span>

namespace troupe::worldio {

/// The checksum of HDF5's metadata: hashlittle() of Bob Jenkins' lookup3 (2006, public domain). A block of
/// metadata ends with the checksum of all bytes before it, as a little-endian number of 4 bytes.
std::uint32_t metadata_checksum(std::span<const std::uint8_t> bytes);

}  // namespace troupe::worldio
