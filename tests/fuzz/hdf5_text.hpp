#pragma once

#include <filesystem>
#include <string_view>

namespace troupe::fuzz {

/// Writes an HDF5 file from a text in which each line describes an attribute or a dataset. Fuzzing mutates
/// the text, so that mutations change the contents of the file, while the file itself stays valid HDF5. The
/// sorts of lines are:
///
///     text /meta kind troupe recording   sets the attribute `kind` of the group /meta to a text; missing
///                                        groups are created
///     int /meta layout 1                 sets an attribute to an integer
///     number /meta tick_s 0.1            sets an attribute to a floating-point number
///     json /world {}                     writes a dataset of one text
///     texts /bodies/name r0 r1           writes a dataset of several texts
///     f64 /state/pose/x 3 2 1 = 0 1 2    writes a dataset of 3 x 2 x 1 numbers of type f64, which repeats
///                                        the numbers after `=`; other types: f32 i64 i32 u64 u32 u8
///
/// At most 4,096 numbers of a dataset are written; the others have the fill value. Returns false if a line is
/// invalid; the file is then incomplete.
bool make_hdf5(std::string_view text, const std::filesystem::path& file);

}  // namespace troupe::fuzz
