#pragma once

#include <filesystem>
#include <optional>
#include <span>

namespace troupe::worldio {

/// Finds a file that a world names. Returns `path` if that file exists; else the file with the same base name
/// in the first folder of the search path that has one. Only regular files count. Empty if there is none.
std::optional<std::filesystem::path> find_stage_file(const std::filesystem::path& path,
                                                     std::span<const std::filesystem::path> search_path);

/// Removes "." and ".." from a path. Returns `path` unchanged if the shorter path would name another file: if
/// x is a link to a folder, "x/.." is the parent of the linked folder, not the folder that contains x.
std::filesystem::path tidied(const std::filesystem::path& path);

}  // namespace troupe::worldio
