#include "troupe/input_files.hpp"

#include "base/diagnostics.hpp"
#include "worldio/files.hpp"
#include "worldio/images/ros_map.hpp"

#include <system_error>
#include <utility>

namespace troupe {
namespace fs = std::filesystem;

std::vector<fs::path> input_files(const engine::WorldSpec& world) {
  std::vector<fs::path> files;
  const auto add = [&](fs::path file) {
    std::error_code ignored;  // the list of sources also contains --set options, which are no files
    if (fs::is_regular_file(file, ignored)) files.push_back(std::move(file));
  };
  for (std::uint32_t i = 0; world.files && i < world.files->size(); ++i) add(world.files->name(i));
  for (const engine::TypeSpec& type : world.types)
    for (const engine::PartSpec& part : type.parts) {
      if (!part.image) continue;
      add(part.image->file);
      Diagnostics ignored;  // errors of a map that was changed after the world was read
      if (!worldio::is_ros_map(part.image->file)) continue;
      if (const auto map = worldio::read_ros_map(part.image->file, {}, ignored)) add(map->image);
    }
  return files;
}

bool same_file(const fs::path& a, const fs::path& b) {
  if (a.empty() || b.empty()) return false;
  std::error_code ignored;
  if (fs::equivalent(a, b, ignored)) return true;
  return worldio::resolved_path(a) == worldio::resolved_path(b);
}

}  // namespace troupe
