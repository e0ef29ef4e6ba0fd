#pragma once

#include <filesystem>
#include <initializer_list>
#include <string_view>

namespace troupe::worldio {

/// Writes the pieces, one after another, to another name beside `file`, and renames that when it is whole:
/// who looks at `file` sees what was there before, or all of it. Throws std::system_error, and leaves nothing
/// behind then. What is neither a file nor a folder (/dev/stdout, a pipe) is written into instead.
void write_whole(const std::filesystem::path& file, std::initializer_list<std::string_view> pieces);

}  // namespace troupe::worldio
