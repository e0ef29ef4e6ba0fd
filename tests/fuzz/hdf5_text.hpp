#pragma once

#include <filesystem>
#include <string_view>

namespace troupe::fuzz {

/// As what the HDF5 file is made: in the format of recordings, with extendible datasets, or in that of
/// checkpoints, with datasets of a fixed size behind a user block.
enum class Hdf5Format { recording, checkpoint };

/// Writes an HDF5 file from a text in which each line describes an attribute or a dataset. Fuzz tests change
/// this text at random. The contents of the file then change, but the file itself remains valid HDF5.
/// Examples of all sorts of lines:
///
///     text /meta kind troupe recording
///         sets the attribute `kind` of the group /meta to the text "troupe recording"
///     int /meta layout 1
///         sets the attribute `layout` of the group /meta to the integer 1
///     number /meta tick_s 0.1
///         sets the attribute `tick_s` of the group /meta to the floating-point number 0.1
///     json /world {}
///         writes the text {} as the dataset /world; with any other path, as the dataset `text` of the group
///         that contains the path
///     texts /bodies/name r0 r1
///         writes the dataset /bodies/name, which consists of the texts "r0" and "r1"
///     f64 /state/pose/x 3 2 1 = 0 1 2
///         writes the dataset /state/pose/x, which consists of 3 x 2 x 1 numbers of type f64. The numbers
///         after `=` are repeated to fill it. Other types: f32 i64 i32 u64 u32 u8
///
/// Groups that do not exist are created. At most 4,096 numbers of a dataset are written; the others keep the
/// fill value of HDF5, and a larger dataset of a fixed size has no values. Returns false if a line is invalid
/// or HDF5 reports an error; the file is then incomplete.
bool make_hdf5(std::string_view text, const std::filesystem::path& file, Hdf5Format format);

}  // namespace troupe::fuzz
