#pragma once

#include <filesystem>
#include <string_view>

namespace troupe::fuzz {

/// Makes an HDF5 file of a text, a line each attribute or dataset, so that what is mutated are the contents
/// and the file itself stays whole:
///
///     text /meta kind troupe recording          an attribute; groups are made on the way
///     int /meta layout 1
///     number /meta tick_s 0.1
///     json /world {}                            a dataset of one text
///     texts /bodies/name r0 r1                  of several
///     f64 /state/pose/x 3 2 1 = 0 1 2           of 3 x 2 x 1 numbers: these, over and over; also f32 i64 i32
///     u64 u32 u8
///
/// Extents may be larger than what is written. False where a line cannot be made: there is then no whole
/// file.
bool make_hdf5(std::string_view text, const std::filesystem::path& file);

}  // namespace troupe::fuzz
