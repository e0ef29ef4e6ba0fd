#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace troupe::worldio {

/// Makes datasets readable again whose metadata is torn. Metadata is torn if the process was killed while the
/// operating system copied a block of metadata to the file: a write that crosses the border between two pages
/// of memory can end at this border. The block then begins with new bytes and ends with old ones, so its
/// checksum is wrong, and HDF5 refuses to read the dataset.
///
/// Each block has a meaning with any mixture of old and new bytes. An object header has either the old or the
/// new number of rows. In the index of the chunks, some of the new chunks are missing, and the address of one
/// chunk may be half written; such an address is beyond the end of the file and is removed. The function
/// therefore only computes the checksums of such blocks again. Afterwards, the dataset may have more rows
/// than chunks, so the caller must truncate it to the complete frames.
///
/// Only blocks that cross a border of pages are changed, and only object headers and extensible arrays, which
/// are the blocks that a writer in SWMR mode overwrites (HDF5 File Format Specification 3.0, sections IV.A
/// and VII.D). The function does not use the HDF5 library, and the file must not have a user block.
///
/// file     a file that no program has open, and whose superblock is closed (close_superblock())
/// headers  addresses of the object headers of the datasets: Hdf5Group::header_addresses()
/// Returns the number of blocks that were torn. If the file cannot be read or written, throws
/// std::runtime_error with the name of the file.
std::size_t mend_torn_metadata(const std::filesystem::path& file, std::span<const std::uint64_t> headers);

}  // namespace troupe::worldio
