#include "worldio/whole_file.hpp"

#include "worldio/partial_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <span>
#include <string_view>
#include <system_error>

namespace troupe::worldio {
namespace {

/// Writes the pieces directly into a device or a pipe. A temporary file that is renamed would replace the
/// device or pipe by a regular file, for all programs.
void write_into(const std::filesystem::path& special, std::initializer_list<std::string_view> pieces) {
  const auto failed = [] { return std::system_error(errno, std::generic_category()); };
  std::FILE* const out = std::fopen(special.c_str(), "wb");
  if (!out) throw failed();
  const auto write = [out](std::string_view piece) {
    return std::fwrite(piece.data(), 1, piece.size(), out) == piece.size();
  };
  const bool written = std::all_of(pieces.begin(), pieces.end(), write) && std::fflush(out) == 0;
  const int error = errno;
  const bool closed = std::fclose(out) == 0;
  if (!written) errno = error;
  if (!written || !closed) throw failed();
}

}  // namespace

void write_whole(const std::filesystem::path& file, std::initializer_list<std::string_view> pieces) {
  std::error_code ignored;
  if (std::filesystem::is_other(file, ignored)) return write_into(file, pieces);
  PartialFile out(file);
  for (const std::string_view piece : pieces) out.write(std::as_bytes(std::span(piece)));
  out.commit();
}

void check_replaceable(const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::is_other(file, ignored)) return;
  const PartialFile trial(file);
}

}  // namespace troupe::worldio
