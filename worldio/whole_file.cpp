#include "worldio/whole_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <system_error>

namespace troupe::worldio {

void write_whole(const std::filesystem::path& file, std::initializer_list<std::string_view> pieces) {
  // A device or a pipe is written into: a rename would put a plain file in its place, for every program.
  std::error_code ignored;
  const bool is_special = std::filesystem::is_other(file, ignored);
  // The process id keeps two programs that write one name out of each other's way.
  std::filesystem::path partial = file;
  if (!is_special) partial += fmt::format(".{}.partial", getpid());
  const auto failed = [&] { return std::system_error(errno, std::generic_category()); };

  std::FILE* const out = std::fopen(partial.c_str(), "wb");
  if (!out) throw failed();
  const auto write = [out](std::string_view piece) {
    return std::fwrite(piece.data(), 1, piece.size(), out) == piece.size();
  };
  const bool written = std::all_of(pieces.begin(), pieces.end(), write) && std::fflush(out) == 0;
  const int write_error = errno;
  const bool closed = std::fclose(out) == 0;
  if (!written) errno = write_error;
  const bool renamed = is_special || (written && closed && std::rename(partial.c_str(), file.c_str()) == 0);
  if (!written || !closed || !renamed) {
    const int reason = errno;
    if (!is_special) std::remove(partial.c_str());
    throw std::system_error(reason, std::generic_category());
  }
}

}  // namespace troupe::worldio
