#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

namespace troupe::worldio {

/// Size of the head of a sealed file, bytes. A sealed file either exists completely or not at all, and
/// check_seal() detects a change of any of its bytes. Its first 512 bytes, the head, are text:
///
///     troupe checkpoint
///     layout 1
///     bytes 123456
///     xxh3 6b0f...
///
/// The head is padded with blanks. Its third line gives the number of bytes that follow the head, and its
/// fourth line gives their XXH3 hash (64 bits). HDF5 ignores the head (its user block), so the tools of HDF5
/// and h5py can open the file.
inline constexpr std::size_t k_seal_bytes = 512;

/// Writes `bytes` as a sealed file. `kind` is the second word of the first line, and `layout` the number in
/// the second line. The head replaces the first k_seal_bytes bytes of `bytes`, which must have at least this
/// size. The function writes to another name in the same folder (worldio/partial_file.hpp), syncs that file
/// to the disk and renames it to `file`. If that fails, or if `file` exists and is not a regular file, throws
/// std::runtime_error with a message such as `run.h5: error: ...`. In this case no partial file remains, and
/// `file` is unchanged.
void write_sealed(const std::filesystem::path& file, std::string_view kind, unsigned layout,
                  std::span<const std::byte> bytes);

/// Reads the whole file and checks its head and hash. `kind` and `layout` are those that the file must have,
/// as in write_sealed(). Throws InputError if the file does not exist, is another kind of file, has another
/// layout, was cut off or is damaged. The message states which of these is the case.
void check_seal(const std::filesystem::path& file, std::string_view kind, unsigned layout);

/// Whether the first line of a file is that of a sealed file of this kind, such as "checkpoint". False if the
/// file cannot be read.
bool has_seal(const std::filesystem::path& file, std::string_view kind);

}  // namespace troupe::worldio
