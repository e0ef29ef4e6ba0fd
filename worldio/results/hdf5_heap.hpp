#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace troupe::worldio {

/// Size of a reference to a text of variable length, bytes. An HDF5 attribute stores this reference in place
/// of the text. The text itself is an object in the global heap of the file, which is divided into
/// collections of objects. The reference consists of the length of the text (4 bytes), the address of the
/// collection (8 bytes) and the number of the object in the collection (4 bytes). See HDF5 File Format
/// Specification 3.0, section VIII.B.
inline constexpr std::size_t k_heap_reference_bytes = 16;

/// Reads the text of variable length to which a reference in an HDF5 file points. Returns std::nullopt if the
/// file cannot be read, or if the reference is not valid because the file is damaged.
/// base       size of the user block, bytes: the user block is the part of the file that precedes all HDF5
///            data, and the address in the reference counts from the end of this block
/// reference  the bytes of the reference, as the attribute stores them
/// The function does not use the HDF5 library. No checksum protects the texts, and a single flipped bit in
/// the global heap makes HDF5 1.10 write and read outside its buffers.
std::optional<std::string> read_heap_text(const std::filesystem::path& file, std::uint64_t base,
                                          std::span<const std::uint8_t, k_heap_reference_bytes> reference);

}  // namespace troupe::worldio
