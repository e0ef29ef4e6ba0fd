#pragma once

#include "engine/spec/world_spec.hpp"

#include <filesystem>
#include <vector>

namespace troupe {

/// Returns the files that a world was read from and that exist: the world file, the files that the world file
/// includes, images, ROS maps, and the scripts that gave the world controllers. A world that a program built
/// has only images, ROS maps and scripts. If WorldBuilder built the world and a file with the name
/// WorldBuilder::name() exists, this file is also in the list.
std::vector<std::filesystem::path> input_files(const engine::WorldSpec& world);

/// Whether two paths name the same file, which need not exist yet; also true if one path is a link, hard or
/// symbolic, to the other. False if one of the paths is empty.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace troupe
