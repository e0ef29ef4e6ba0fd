#pragma once

#include <filesystem>
#include <initializer_list>
#include <string_view>

namespace troupe::worldio {

/// Writes the concatenated pieces to a temporary file in the folder of `file` and renames it when complete,
/// so that readers see either the old content or the whole new one. Throws std::system_error and then leaves
/// no temporary file. If `file` is a device or a pipe (/dev/stdout), writes directly into it.
void write_whole(const std::filesystem::path& file, std::initializer_list<std::string_view> pieces);

}  // namespace troupe::worldio
