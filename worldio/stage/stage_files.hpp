#pragma once

#include <filesystem>
#include <optional>
#include <span>

namespace troupe::worldio {

/// Finds a file that a world names. Returns `path` if that file exists; else the file with the same base name
/// in the first folder of the search path that has one. Only regular files count. Empty if there is none.
std::optional<std::filesystem::path> find_stage_file(const std::filesystem::path& path,
                                                     std::span<const std::filesystem::path> search_path);

/// Returns a path without "." and ".." if the shorter path names the same file; else the path unchanged. The
/// shorter path may name another file: if x is a link to a folder, "x/.." is the parent of the linked folder.
std::filesystem::path tidied(const std::filesystem::path& path);

}  // namespace troupe::worldio
