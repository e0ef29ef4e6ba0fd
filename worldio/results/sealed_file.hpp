#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

namespace troupe::worldio {

/// A file that is there whole or not at all, and shows any byte that changed later. Its first 512 bytes are
/// text:
///
///     troupe checkpoint
///     layout 1
///     bytes 123456
///     xxh3 6b0f...
///
/// filled up with blanks; then come `bytes` bytes, whose XXH3 (64 bits) the fourth line says. HDF5 takes such
/// a head for a user block, so that its own tools and h5py open the file.
inline constexpr std::size_t k_seal_bytes = 512;

/// Writes the head and what follows it in `bytes`, whose own first 512 are room for the head: to another name
/// beside `file` (worldio/partial_file.hpp), hands it to the disk, and gives it its name. Throws
/// std::runtime_error `run.h5: error: ...` where that fails; no partial file is left then, and `file` is what
/// it was.
void write_sealed(const std::filesystem::path& file, std::string_view kind, unsigned layout,
                  std::span<const std::byte> bytes);

/// Reads all of the file. Throws InputError that says what is wrong with it: it is not there, is something
/// else, is of a newer layout, was cut off, or is damaged.
void check_seal(const std::filesystem::path& file, std::string_view kind, unsigned layout);

/// Whether the file begins like one of this kind.
bool has_seal(const std::filesystem::path& file, std::string_view kind);

}  // namespace troupe::worldio
