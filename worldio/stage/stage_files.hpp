#pragma once

#include <filesystem>
#include <optional>
#include <span>

namespace troupe::worldio {

/// Finds a file of a world: `path` itself, else its base name in the first directory of the search path that
/// has it. Only regular files count. Empty if there is none.
std::optional<std::filesystem::path> find_stage_file(const std::filesystem::path& path,
                                                     std::span<const std::filesystem::path> search_path);

/// Removes "." and ".." from a path if the result names the same file. It does not always: where x is a link
/// to a folder, "x/.." is the parent of the linked folder.
std::filesystem::path tidied(const std::filesystem::path& path);

}  // namespace troupe::worldio
