#include "troupe/input_files.hpp"

#include "base/diagnostics.hpp"
#include "worldio/images/ros_map.hpp"

#include <optional>
#include <system_error>
#include <utility>

namespace troupe {
namespace fs = std::filesystem;
namespace {

constexpr int k_most_links = 40;  // as on Linux: more symbolic links in a row are an error

}  // namespace

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

fs::path resolved_path(const fs::path& file) {
  std::error_code ignored;
  fs::path path = fs::absolute(file, ignored);
  // weakly_canonical() does not resolve a symbolic link to a file that does not exist.
  for (int links = 0; links < k_most_links && fs::is_symlink(path, ignored); ++links) {
    const fs::path target = fs::read_symlink(path, ignored);
    path = path.parent_path() / target;  // the target alone, if it is absolute
  }
  // The path is absolute, because weakly_canonical() does not change a relative name that does not exist yet.
  return fs::weakly_canonical(path, ignored);
}

bool same_file(const fs::path& a, const fs::path& b) {
  if (a.empty() || b.empty()) return false;
  std::error_code ignored;
  if (fs::equivalent(a, b, ignored)) return true;
  return resolved_path(a) == resolved_path(b);
}

}  // namespace troupe
