#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace troupe::worldio {

/// Number of bytes at the start of a file that wrong_file_text() needs.
inline constexpr std::size_t k_wrong_file_bytes = 4096;

/// If a file where a world is expected is of another known type, returns the text of an error that says of
/// which one, and which command takes such a file. Empty for a file that may be a world. The type follows
/// from the content: world files of other simulators, robot and map descriptions, configurations, web pages,
/// results of Troupe, pictures, other binary files, and empty files.
///
/// start: the first bytes of the file, k_wrong_file_bytes if it has so many
std::optional<std::string> wrong_file_text(std::string_view start);

}  // namespace troupe::worldio
