#pragma once

#include "base/result.hpp"

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>

namespace troupe::worldio {

/// The largest text or image that is read: more is no world, but a mistake.
inline constexpr std::uintmax_t k_most_input_bytes = std::uintmax_t{4} << 30;

/// Whether a file can be an input; else "there is no such file", "this is a folder", "this is a pipe, no
/// regular file", ... Only regular files can: reading a device or a pipe might never end, and even opening a
/// pipe might wait for ever. Nothing is opened.
Result<> check_readable(const std::filesystem::path& file,
                        std::uintmax_t most_bytes = std::numeric_limits<std::uintmax_t>::max());

/// The bytes of a regular file of at most k_most_input_bytes; empty when it cannot be read.
std::optional<std::string> read_file(const std::filesystem::path& path);

}  // namespace troupe::worldio
