#pragma once

#include "base/result.hpp"

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace troupe::worldio {

/// Greatest size of a text or image file that is read, in bytes (4 GiB). Image files have a further limit of
/// 2^31 - 1 bytes (decode_bitmap()).
inline constexpr std::uintmax_t k_most_input_bytes = std::uintmax_t{4} << 30;

/// Checks that a file is a readable regular file of at most `most_bytes` bytes, without opening the file. A
/// link counts as the file that it refers to. The error is a phrase such as "there is no such file", "this is
/// a folder, not a file" or "this is a pipe, not a regular file", without the name of the file. Devices and
/// pipes are refused because reading them might never end, and opening a pipe can block forever.
Result<> check_readable(const std::filesystem::path& file,
                        std::uintmax_t most_bytes = std::numeric_limits<std::uintmax_t>::max());

/// Returns the message of an error about the file `from` as a message about the file `to`, whose content was
/// to be written to `from` first: if the message begins with the path `from`, replaces it by the path `to`.
std::string error_about(std::string_view message, const std::filesystem::path& from,
                        const std::filesystem::path& to);

/// Returns why a file cannot be written, for messages: "there is no folder DIR" if the folder of the file is
/// missing, otherwise `reason`, the text that the system gives.
std::string write_failure(const std::filesystem::path& file, const std::string& reason);

/// Returns the absolute path of a file without symbolic links, also if the file or the file to which a link
/// points does not exist. If the system cannot resolve the path, for example because it is too long, its
/// links remain; if the working folder has been removed, the result is relative.
std::filesystem::path resolved_path(const std::filesystem::path& file);

/// Whether the ending of a file name is that of another format of results than HDF5: `.csv`, `.html`,
/// `.json`, `.mp4`, `.pdf`, `.png` or `.svg`, in small or capital letters. HDF5 files, such as recordings and
/// checkpoints, must not have such a name, which would mislead people and programs.
bool has_ending_of_other_format(const std::filesystem::path& file);
/// Throws InputError, `run.csv: error: ...`, if the ending of a file name is that of another format than HDF5
/// (has_ending_of_other_format()).
void require_hdf5_ending(const std::filesystem::path& file);

/// Returns the first bytes of a file, at most `most_bytes`; empty if it cannot be read.
std::string start_of(const std::filesystem::path& file, std::size_t most_bytes);

/// Returns the content of a regular file of at most k_most_input_bytes bytes. Returns nothing if the file is
/// larger, is not a regular file or cannot be read.
std::optional<std::string> read_file(const std::filesystem::path& path);

/// A new file, open for writing. The caller must close the descriptor.
struct NewFile {
  std::filesystem::path path;
  int descriptor = -1;
};
/// Creates an empty file, and never replaces one. The name of the file is the first of STEM.WHAT.ENDING,
/// STEM.WHAT-2.ENDING, STEM.WHAT-3.ENDING, ... that does not exist in `folder`. A symbolic link exists even
/// if its target does not. Two processes never get the same file. The error names the file, as in
/// `w.session.jsonl: error: cannot be written: Permission denied`. It is also an error if all names up to
/// number 100,000 exist.
Result<NewFile> create_new_file(const std::filesystem::path& folder, std::string_view stem,
                                std::string_view what, std::string_view ending);

}  // namespace troupe::worldio
