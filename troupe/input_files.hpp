#pragma once

#include "engine/spec/world_spec.hpp"

#include <filesystem>
#include <vector>

namespace troupe {

/// Returns the files that a world was read from and that exist: the world file, the files that the world file
/// includes, images, ROS maps, and the scripts (such as Python files) with controllers of its robots. A world
/// that a program built has no world file, but may have images, ROS maps and scripts. For a world that a
/// WorldBuilder built, WorldBuilder::name() takes the place of the name of a world file: if a file of this
/// name exists, it is also in the list.
std::vector<std::filesystem::path> input_files(const engine::WorldSpec& world);

/// Whether two paths name the same file, which need not exist yet; also true if one path is a link, hard or
/// symbolic, to the other. False if one of the paths is empty.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace troupe
