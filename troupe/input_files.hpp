#pragma once

#include "engine/spec/world_spec.hpp"

#include <filesystem>
#include <vector>

namespace troupe {

/// The files that a world was read from, as far as they exist: the world file, the files that it includes,
/// its images and ROS maps, and the scripts that gave it controllers. A world that a program built has only
/// images, ROS maps and scripts, and, if WorldBuilder built it, a file with the builder's name if there is
/// one.
std::vector<std::filesystem::path> input_files(const engine::WorldSpec& world);

/// Whether two paths name the same file, which need not exist yet; also true if one path is a link, hard or
/// symbolic, to the other. False if one of the paths is empty.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace troupe
