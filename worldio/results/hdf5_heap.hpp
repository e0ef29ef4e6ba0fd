#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace troupe::worldio {

/// Size of a reference to a text of variable length, as attributes store it, in bytes: the length of the
/// text, the address of its collection in the global heap, and the number of the object there (HDF5 File
/// Format Specification 3.0, section VIII.B), for addresses of 8 bytes.
inline constexpr std::size_t k_heap_reference_bytes = 16;

/// Reads a text of variable length from the file without HDF5. No checksum protects the global heap: one
/// flipped bit in it makes HDF5 1.10 write and read beyond its buffers. Addresses count from `base`, the size
/// of the user block. Empty if the file holds no such text: it is damaged.
std::optional<std::string> read_heap_text(const std::filesystem::path& file, std::uint64_t base,
                                          std::span<const std::uint8_t, k_heap_reference_bytes> reference);

}  // namespace troupe::worldio
