#pragma once

#include <filesystem>
#include <optional>
#include <span>

namespace troupe::worldio {

/// Finds a file that a world of Stage (an older robot simulator, whose files Troupe reads) names. Returns
/// `path` if that file exists. Otherwise, searches the folders of `search_path` in their order for a file
/// whose name is the last component of `path`, and returns the path of the first one. Only regular files, and
/// links to them, count. Empty if there is no such file.
std::optional<std::filesystem::path> find_stage_file(const std::filesystem::path& path,
                                                     std::span<const std::filesystem::path> search_path);

/// Removes "." from a path, and each ".." together with the component before it; a ".." at the beginning
/// stays. Returns `path` unchanged if the shorter path would name another file. That happens if x is a link
/// to a folder: "x/.." is then the parent of the linked folder, not the folder that contains x.
std::filesystem::path tidied(const std::filesystem::path& path);

}  // namespace troupe::worldio
