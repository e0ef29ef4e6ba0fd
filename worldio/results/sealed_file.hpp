#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

namespace troupe::worldio {

/// A sealed file exists completely or not at all, and any byte that changes later is detected. Its first 512
/// bytes are text:
///
///     troupe checkpoint
///     layout 1
///     bytes 123456
///     xxh3 6b0f...
///
/// padded with blanks. Then follow `bytes` bytes, whose XXH3 (64 bits) is in the fourth line. HDF5 takes this
/// head for a user block, so its own tools and h5py can open the file.
inline constexpr std::size_t k_seal_bytes = 512;

/// Writes a head and `bytes` without its first 512, which leave room for the head. Writes to another name
/// next to `file` (worldio/partial_file.hpp), syncs it to the disk and renames it. Throws std::runtime_error
/// `run.h5: error: ...` if that fails; then there is no partial file, and `file` is unchanged.
void write_sealed(const std::filesystem::path& file, std::string_view kind, unsigned layout,
                  std::span<const std::byte> bytes);

/// Reads and checks the whole file. Throws InputError with what is wrong: it does not exist, is another kind
/// of file, has another layout, was cut off, or is damaged.
void check_seal(const std::filesystem::path& file, std::string_view kind, unsigned layout);

/// Whether a file begins like a sealed file of this kind.
bool has_seal(const std::filesystem::path& file, std::string_view kind);

}  // namespace troupe::worldio
