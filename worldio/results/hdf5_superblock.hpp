#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string_view>

namespace troupe::worldio {

/// The bytes with which an HDF5 file begins. If the file has a user block (bytes at the beginning that HDF5
/// ignores), these bytes follow the user block.
inline constexpr std::string_view k_hdf5_signature = "\x89HDF\r\n\x1a\n";

/// The address in an HDF5 file that stands for no address.
inline constexpr std::uint64_t k_hdf5_no_address = std::numeric_limits<std::uint64_t>::max();

/// Two fields of the superblock, which is the header of an HDF5 file (HDF5 File Format Specification 3.0,
/// section II.A, versions 2 and 3). The fields show whether the file is marked as open for writing. They are
/// needed to repair a file whose writer was killed. The functions below read and write the fields without the
/// HDF5 library.
struct Hdf5Superblock {
  /// The bit k_writing is set while a program has the file open for writing. The bit k_swmr_writing is also
  /// set if this program writes in SWMR mode ("single writer, multiple readers"). A writer that is killed
  /// leaves the bits set.
  std::uint8_t flags = 0;
  std::uint64_t end = 0;  ///< size of the file according to the superblock, bytes

  static constexpr std::uint8_t k_writing = 1;
  static constexpr std::uint8_t k_swmr_writing = 4;
  bool writing() const { return (flags & (k_writing | k_swmr_writing)) != 0; }
  bool swmr_writing() const { return (flags & k_swmr_writing) != 0; }
};

/// Reads two fields of the superblock of a file. Returns std::nullopt if the file cannot be read, or if it
/// does not begin with a complete superblock of version 2 or 3 with a correct checksum. A new file has no
/// superblock until HDF5 flushes it for the first time.
std::optional<Hdf5Superblock> read_superblock(const std::filesystem::path& file);

/// Marks a file as closed, so that ordinary HDF5 tools open it. Use this function only if the writer of the
/// file was killed or has failed. The function also makes the size in the superblock equal to the size of the
/// file. For this, a file that is too short is extended with zeros; for a file that is too long, the size in
/// the superblock is changed. The superblock (48 bytes) is written in a single write, so it is never half
/// changed. On failure, throws std::runtime_error with the name of the file and the reason.
void close_superblock(const std::filesystem::path& file);

}  // namespace troupe::worldio
