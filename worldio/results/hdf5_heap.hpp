#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace troupe::worldio {

/// Size, in bytes, of the reference that an attribute stores in place of a text of variable length. The text
/// itself is an object in the global heap, a part of the file that consists of collections of objects. The
/// reference consists of the length of the text (4 bytes), the address of the collection (8 bytes) and the
/// number of the object in this collection (4 bytes). See HDF5 File Format Specification 3.0, section VIII.B.
inline constexpr std::size_t k_heap_reference_bytes = 16;

/// Reads a text of variable length from the file without the HDF5 library. The library is not used because no
/// checksum protects the global heap: one flipped bit in it makes HDF5 1.10 write and read beyond its
/// buffers. `reference` is the reference to the text, as the file stores it. The address in the reference
/// counts from the end of the user block, which is the first `base` bytes of the file. Empty if the file
/// cannot be read, or if the reference is not valid because the file is damaged.
std::optional<std::string> read_heap_text(const std::filesystem::path& file, std::uint64_t base,
                                          std::span<const std::uint8_t, k_heap_reference_bytes> reference);

}  // namespace troupe::worldio
