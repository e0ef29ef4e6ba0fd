#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

/// Sealed files, such as checkpoints. A sealed file is written completely or not at all, and check_seal()
/// detects a change of any of its bytes. The file begins with a head: 512 bytes of text, padded with blanks.
///
///     troupe checkpoint
///     layout 1
///     bytes 123456
///     xxh3 6b0f...
///
/// The third line gives the number of bytes that follow the head, and the fourth line gives the XXH3 hash (64
/// bits) of these bytes. If they are HDF5 data, the tools of HDF5 and h5py can open the file, because HDF5
/// ignores the head.
namespace troupe::worldio {

/// Size of the head of a sealed file, bytes.
inline constexpr std::size_t k_seal_bytes = 512;

/// Writes a sealed file.
/// kind    second word of the first line of the head, such as "checkpoint"
/// layout  number in the second line of the head
/// bytes   content of the file, at least k_seal_bytes bytes; the head replaces its first k_seal_bytes bytes
/// The function writes a temporary file in the same folder (worldio/partial_file.hpp), flushes it to the disk
/// and renames it to `file`. If that fails, or if `file` exists and is not a regular file, throws
/// std::runtime_error with a message such as `run.h5: error: ...`. After an error, `file` is unchanged and no
/// temporary file remains.
void write_sealed(const std::filesystem::path& file, std::string_view kind, unsigned layout,
                  std::span<const std::byte> bytes);

/// Reads the whole file and checks its head and hash. `kind` and `layout` are the values that the head must
/// have (see write_sealed()). Throws InputError if the file does not exist, cannot be read, is another kind
/// of file, has another layout, was cut off or is damaged. The message states which of these is the case.
void check_seal(const std::filesystem::path& file, std::string_view kind, unsigned layout);

/// Whether the first line of a file is that of a sealed file of this kind, such as "checkpoint". The rest of
/// the file is not checked. Returns false if the file cannot be read.
bool has_seal(const std::filesystem::path& file, std::string_view kind);

}  // namespace troupe::worldio
