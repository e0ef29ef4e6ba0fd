#pragma once

#include "troupe/simulation.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace troupe {

/// Finds probable mistakes in a world that can be loaded: all warnings of loading it, at every place, and
///   - bodies that overlap at the start, robots that start in walls;
///   - sensors that can never detect anything, floor plans that block no robot;
///   - unused definitions, properties without effect.
/// Each finding is a line `file:line: warning: ...`, in the order of files and lines. At most a hundred
/// overlaps are listed, the others are counted. Empty: nothing was found. Throws InputError if the world
/// cannot be loaded.
std::vector<std::string> lint(const std::filesystem::path& world, const SimulationOptions& options = {});

}  // namespace troupe
