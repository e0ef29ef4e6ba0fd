#pragma once

#include <filesystem>
#include <string>

namespace troupe::worldio {

/// Writes a file beside its name and renames it when it is whole, so that nobody ever finds half of it.
/// Throws std::system_error; leaves nothing behind then, and what was there before as it was.
void write_whole(const std::filesystem::path& file, const std::string& bytes);

}  // namespace troupe::worldio
