#pragma once

#include "engine/spec/world_spec.hpp"

#include <filesystem>
#include <vector>

namespace troupe {

/// Returns the existing files from which a world was read: the world file and the files that it includes,
/// images, ROS maps, and the scripts (such as Python files) with controllers of its robots. A world that a
/// program built has no world file. If it was built by a WorldBuilder, and a file with the name
/// WorldBuilder::name() exists, the list contains this file.
std::vector<std::filesystem::path> input_files(const engine::WorldSpec& world);

/// Whether two paths refer to the same file, directly or through hard or symbolic links. The file need not
/// exist. False if one of the paths is empty.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace troupe
