#include "worldio/stage/stage_files.hpp"

#include <algorithm>
#include <array>
#include <system_error>

namespace troupe::worldio {
namespace {

bool is_file(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

constexpr auto k_stock = std::to_array<std::string_view>(
    {"beacons.inc", "chatterbox.inc", "hokuyo.inc", "irobot.inc", "map.inc", "objects.inc", "pantilt.inc",
     "pioneer.inc", "sick.inc", "ubot.inc", "uoa_robotics_lab_models.inc", "walle.inc"});

}  // namespace

bool comes_with_stage(std::string_view name) { return std::ranges::find(k_stock, name) != k_stock.end(); }

std::optional<std::filesystem::path> find_stage_file(const std::filesystem::path& path,
                                                     std::span<const std::filesystem::path> search_path) {
  if (is_file(path)) return path;
  for (const std::filesystem::path& directory : search_path)
    if (std::filesystem::path candidate = directory / path.filename(); is_file(candidate)) return candidate;
  return {};
}

std::filesystem::path tidied(const std::filesystem::path& path) {
  std::filesystem::path normal = path.lexically_normal();
  std::error_code error;
  const bool is_other =
      std::filesystem::exists(path, error) && !std::filesystem::equivalent(path, normal, error);
  return is_other ? path : normal;
}

}  // namespace troupe::worldio
