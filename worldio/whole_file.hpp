#pragma once

#include <filesystem>
#include <initializer_list>
#include <string_view>

namespace troupe::worldio {

/// Writes a file whose content is the concatenation of `pieces`. The function writes a temporary file in the
/// same folder. When this file is complete, the function renames it to `file`. Other programs therefore see
/// either the old content or the whole new content. If `file` is a device or a pipe, such as /dev/stdout, the
/// function writes directly into it.
///
/// On failure, throws std::system_error, which has the reason but no path. No temporary file remains.
void write_whole(const std::filesystem::path& file, std::initializer_list<std::string_view> pieces);

/// Checks that write_whole() can write `file`: that its temporary file can be created, and can replace an
/// existing file `file`, which for example a mount point does not allow. Creates the temporary file and
/// removes it. Accepts devices and pipes, without opening them. On failure, throws std::system_error as
/// write_whole() does.
void check_replaceable(const std::filesystem::path& file);

}  // namespace troupe::worldio
