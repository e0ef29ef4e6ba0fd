#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

namespace troupe::worldio {

/// The first bytes of an HDF5 file, unless it begins with a user block.
inline constexpr std::string_view k_hdf5_signature = "\x89HDF\r\n\x1a\n";

/// Two fields of the superblock, which is the header of an HDF5 file (HDF5 File Format Specification 3.0,
/// section II.A, versions 2 and 3). They show whether a program has the file open for writing, or was killed
/// while it did, and are needed to repair the file in the second case. They are read and written without the
/// HDF5 library.
struct Hdf5Superblock {
  /// Bits that a writer sets while it has the file open: k_writing, and in SWMR mode ("single writer,
  /// multiple readers") k_swmr_writing.
  std::uint8_t flags = 0;
  std::uint64_t end = 0;  ///< size of the file, as the writer recorded it here, bytes

  static constexpr std::uint8_t k_writing = 1;
  static constexpr std::uint8_t k_swmr_writing = 4;
  bool writing() const { return (flags & (k_writing | k_swmr_writing)) != 0; }
  bool swmr_writing() const { return (flags & k_swmr_writing) != 0; }
};

/// Reads the superblock of a file. Empty if the file cannot be read, or does not begin with a complete
/// superblock of version 2 or 3 with a correct checksum. HDF5 writes the superblock with the first flush.
std::optional<Hdf5Superblock> read_superblock(const std::filesystem::path& file);

/// Marks a file as closed after its writer was killed, so that ordinary HDF5 tools open the file. If the file
/// is shorter than the size in its superblock, the file is extended to this size with zeros; if it is longer,
/// the superblock gets the real size. The superblock is written as a whole (48 bytes) in a single write, so
/// that it is never half changed. On failure, throws std::runtime_error with the name of the file and the
/// reason.
void close_superblock(const std::filesystem::path& file);

}  // namespace troupe::worldio
