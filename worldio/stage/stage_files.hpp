#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

namespace troupe::worldio {

/// Finds a file that a world file of Stage names. Stage is an older robot simulator, whose files Troupe
/// reads. Returns `path` if that file exists. Otherwise, searches the folders of `search_path` in their order
/// for a file whose name is the last component of `path`, and returns the path of the first one. Only regular
/// files, and links to them, count. Returns std::nullopt if there is no such file.
std::optional<std::filesystem::path> find_stage_file(const std::filesystem::path& path,
                                                     std::span<const std::filesystem::path> search_path);

/// Shortens a path: removes "." and each ".." together with the component before it. A ".." at the beginning
/// remains. If the shorter path would name another file, returns `path` unchanged. For example, "a/x/.." is
/// not shortened to "a" if x is a link to a folder, because ".." is then the parent of the linked folder.
std::filesystem::path tidied(const std::filesystem::path& path);

/// Whether Stage comes with a file of this name for other worlds to include, such as "pioneer.inc".
bool comes_with_stage(std::string_view name);

}  // namespace troupe::worldio
