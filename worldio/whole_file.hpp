#pragma once

#include <filesystem>
#include <initializer_list>
#include <string_view>

namespace troupe::worldio {

/// Writes a file whose content is the concatenation of `pieces`. The function writes a temporary file in the
/// same folder and renames it to `file` when it is complete, so that readers see either the old content or
/// the whole new content. On failure it throws std::system_error, which has the reason but no path, and
/// leaves no temporary file. If `file` is a device or a pipe, such as /dev/stdout, the function writes
/// directly into the device or pipe.
void write_whole(const std::filesystem::path& file, std::initializer_list<std::string_view> pieces);

}  // namespace troupe::worldio
