#pragma once

#include "troupe/simulation.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace troupe {

/// Finds probable mistakes in a world that can be loaded. The findings are the warnings that loading the
/// world gives, and:
///   - bodies that overlap at the start, robots that start in walls;
///   - sensors that can never detect anything, floor plans (walls that an image describes) that block no
///     robot;
///   - unused definitions, properties without effect.
/// Returns one line per finding, `file:line: warning: ...`, in the order of files and lines, and then the
/// warnings about plug-ins (shared libraries with controllers or devices). The list is empty if there are no
/// findings. It contains at most 100 overlaps of bodies, and at most 100 robots that start inside a wall that
/// does not block them. If there are more overlaps or more such robots, one further line states how many
/// more. Throws InputError if the world cannot be loaded, as the constructor of Simulation does.
std::vector<std::string> lint(const std::filesystem::path& world, const SimulationOptions& options = {});

}  // namespace troupe
