#pragma once

#include <filesystem>
#include <initializer_list>
#include <string_view>

namespace troupe::worldio {

/// Writes the concatenated pieces to a temporary file in the folder of `file` and renames this file when it
/// is complete, so that readers see either the old content or the whole new content. On failure it throws
/// std::system_error and leaves no temporary file. If `file` is a device or a pipe, such as /dev/stdout, it
/// writes directly into it.
void write_whole(const std::filesystem::path& file, std::initializer_list<std::string_view> pieces);

}  // namespace troupe::worldio
