#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

namespace troupe::worldio {

/// What an HDF5 file begins with, unless a head of its user stands before it.
inline constexpr std::string_view k_hdf5_signature = "\x89HDF\r\n\x1a\n";

/// The head of an HDF5 file as far as the death of its writer concerns it (HDF5 File Format
/// Specification 3.0, section II.A, versions 2 and 3), read and written without HDF5.
struct Hdf5Superblock {
  std::uint8_t flags = 0;  ///< whether a writer has the file open
  std::uint64_t end = 0;   ///< where the writer thought that the file ends, bytes

  static constexpr std::uint8_t k_writing = 1;
  static constexpr std::uint8_t k_swmr_writing = 4;
  bool writing() const { return (flags & (k_writing | k_swmr_writing)) != 0; }
  bool swmr_writing() const { return (flags & k_swmr_writing) != 0; }
};

/// None where the file has no whole head of these versions at its first byte: HDF5 writes it with the first
/// flush.
std::optional<Hdf5Superblock> read_superblock(const std::filesystem::path& file);

/// Marks a file that is no longer written as closed, so that plain tools open it, and puts its end where it
/// is. Nothing else in it changes, and the change is of 48 bytes in one write: it happens or it does not.
/// Throws std::runtime_error with the file and the reason.
void close_superblock(const std::filesystem::path& file);

}  // namespace troupe::worldio
