#pragma once

#include "base/result.hpp"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace troupe::worldio {

/// A part of a file, bytes.
struct FileBlock {
  std::uint64_t at = 0;  ///< its first byte, counted from the beginning of the file
  std::uint64_t bytes = 0;
};

/// Checks the metadata of an HDF5 file with a user block, as Hdf5File::create_in_memory() makes it, without
/// the HDF5 library. Metadata is everything except the values of datasets: the superblock, the headers of
/// objects with their attributes, and the indexes of groups. In this oldest format, metadata has no checksum,
/// and HDF5 1.10 uses many of its addresses and sizes unchecked, so that a file of unknown origin can make it
/// read and write outside its buffers.
///
/// The function accepts only what Troupe writes: datasets of the types of engine::Element and of texts, whose
/// values are stored contiguously and have exactly the size of the extent; attributes that are texts or
/// numbers; groups with a symbol table. All blocks must be inside the file, and no two may overlap.
///
/// user_block  size of the user block, bytes
/// Returns the blocks of metadata in ascending order. The error is a sentence without the name of the file,
/// such as "/bodies/type is damaged: it has more values than are stored".
Result<std::vector<FileBlock>> check_metadata(const std::filesystem::path& file, std::uint64_t user_block);

}  // namespace troupe::worldio
