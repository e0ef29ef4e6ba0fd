#pragma once

#include <filesystem>
#include <optional>
#include <span>

namespace troupe::worldio {

/// Where a file of a world lies: at `path`, or else by its base name in the first directory of the search
/// path that has it. Only regular files count. Empty when it is nowhere.
std::optional<std::filesystem::path> find_stage_file(const std::filesystem::path& path,
                                                     std::span<const std::filesystem::path> search_path);

/// The path without its "." and "..", where that names the same file: behind a link to a folder "x/.." may be
/// elsewhere.
std::filesystem::path tidied(const std::filesystem::path& path);

}  // namespace troupe::worldio
