#include "worldio/files.hpp"

#include "base/diagnostics.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <system_error>

namespace troupe::worldio {

Result<> check_readable(const std::filesystem::path& file, std::uintmax_t most_bytes) {
  const auto system_reason = [] {
    return Error{fmt::format("cannot be read: {}", std::generic_category().message(errno))};
  };
  struct stat status {};
  if (stat(file.c_str(), &status) != 0) {
    if (errno != ENOENT && errno != ENOTDIR) return system_reason();
    std::error_code ignored;
    if (std::filesystem::is_symlink(file, ignored))
      return Error{fmt::format("this is a link to {}, which does not exist",
                               std::filesystem::read_symlink(file, ignored).string())};
    return Error{"there is no such file"};
  }
  if (S_ISDIR(status.st_mode)) return Error{"this is a folder, not a file"};
  if (S_ISFIFO(status.st_mode)) return Error{"this is a pipe, not a regular file"};
  if (S_ISSOCK(status.st_mode)) return Error{"this is a socket, not a regular file"};
  if (!S_ISREG(status.st_mode)) return Error{"this is a device, not a regular file"};
  if (access(file.c_str(), R_OK) != 0) return system_reason();
  if (static_cast<std::uintmax_t>(status.st_size) > most_bytes)
    return Error{
        fmt::format("the file is too large: {} bytes; at most {} are allowed", status.st_size, most_bytes)};
  return {};
}

std::string error_about(std::string_view message, const std::filesystem::path& from,
                        const std::filesystem::path& to) {
  if (!message.starts_with(from.string())) return std::string(message);
  return to.string().append(message.substr(from.string().size()));
}

std::string write_failure(const std::filesystem::path& file, const std::string& reason) {
  std::error_code ignored;
  const std::filesystem::path folder = file.parent_path();
  const bool is_missing = !folder.empty() && std::filesystem::status(folder, ignored).type() ==
                                                 std::filesystem::file_type::not_found;
  return is_missing ? fmt::format("there is no folder {}", folder.string()) : reason;
}

std::filesystem::path resolved_path(const std::filesystem::path& file) {
  constexpr int k_most_links = 40;  // as on Linux: more symbolic links in a row are an error
  std::error_code ignored;
  std::filesystem::path path = std::filesystem::absolute(file, ignored);
  // weakly_canonical() does not resolve a symbolic link to a file that does not exist.
  for (int links = 0; links < k_most_links && std::filesystem::is_symlink(path, ignored); ++links) {
    const std::filesystem::path target = std::filesystem::read_symlink(path, ignored);
    path = path.parent_path() / target;  // the target alone, if it is absolute
  }
  // The path is absolute, because weakly_canonical() does not change a relative name that does not exist yet.
  std::filesystem::path resolved = std::filesystem::weakly_canonical(path, ignored);
  if (resolved.empty()) resolved = (path.empty() ? file : path).lexically_normal();
  return resolved;
}

bool has_ending_of_other_format(const std::filesystem::path& file) {
  constexpr std::array<std::string_view, 7> k_endings{".csv", ".html", ".json", ".mp4",
                                                      ".pdf", ".png",  ".svg"};
  std::string ending = file.extension().string();
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return std::ranges::find(k_endings, ending) != k_endings.end();
}

void require_hdf5_ending(const std::filesystem::path& file) {
  if (has_ending_of_other_format(file))
    throw InputError(fmt::format(
        "{}: error: the file would be in the format HDF5, but {} is the ending of another format: choose "
        "another ending, such as .h5",
        file.string(), file.extension().string()));
}

std::string start_of(const std::filesystem::path& file, std::size_t most_bytes) {
  if (!check_readable(file)) return {};
  std::string start(most_bytes, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(stream.gcount()));
  return start;
}

std::optional<std::string> read_file(const std::filesystem::path& path) {
  if (!check_readable(path, k_most_input_bytes)) return {};
  std::ifstream in(path, std::ios::binary);
  if (!in) return {};
  std::string text;
  std::string chunk(1 << 16, '\0');  // not on the stack, which `ulimit -s` may limit
  while (in.read(chunk.data(), chunk.size()) || in.gcount() > 0)
    text.append(chunk.data(), static_cast<std::size_t>(in.gcount()));
  if (in.bad()) return {};
  return text;
}

Result<NewFile> create_new_file(const std::filesystem::path& folder, std::string_view stem,
                                std::string_view what, std::string_view ending) {
  constexpr int k_most_files = 100000;  // largest number of files with the same stem and `what` in a folder
  const auto name = [&](int i) {
    return i == 1 ? fmt::format("{}.{}.{}", stem, what, ending)
                  : fmt::format("{}.{}-{}.{}", stem, what, i, ending);
  };
  for (int i = 1; i <= k_most_files; ++i) {
    NewFile file{folder / name(i)};
    file.descriptor = open(file.path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    if (file.descriptor >= 0) return file;
    if (errno != EEXIST)
      return Error{fmt::format("{}: error: cannot be written: {}", file.path.string(),
                               std::generic_category().message(errno))};
  }
  return Error{
      fmt::format("{}: error: this file and all others up to {} exist: move some of them to another folder",
                  (folder / name(1)).string(), name(k_most_files))};
}

}  // namespace troupe::worldio
