#include "worldio/stage_files.hpp"

#include "worldio/input_file.hpp"

#include <array>
#include <fstream>
#include <system_error>

namespace troupe::worldio {
namespace {

bool is_file(const std::filesystem::path& path) {
  std::error_code fault;
  return std::filesystem::is_regular_file(path, fault);
}

}  // namespace

std::optional<std::filesystem::path> find_stage_file(const std::filesystem::path& path,
                                                     std::span<const std::filesystem::path> search_path) {
  if (is_file(path)) return path;
  for (const std::filesystem::path& directory : search_path)
    if (std::filesystem::path candidate = directory / path.filename(); is_file(candidate)) return candidate;
  return {};
}

std::filesystem::path tidied(const std::filesystem::path& path) {
  std::filesystem::path normal = path.lexically_normal();
  std::error_code fault;
  const bool is_other =
      std::filesystem::exists(path, fault) && !std::filesystem::equivalent(path, normal, fault);
  return is_other ? path : normal;
}

std::optional<std::string> read_file(const std::filesystem::path& path) {
  if (!check_readable(path, k_most_input_bytes)) return {};
  std::ifstream in(path, std::ios::binary);
  if (!in) return {};
  std::string text;
  std::array<char, 1 << 16> chunk;
  while (in.read(chunk.data(), chunk.size()) || in.gcount() > 0)
    text.append(chunk.data(), static_cast<std::size_t>(in.gcount()));
  if (in.bad()) return {};
  return text;
}

}  // namespace troupe::worldio
