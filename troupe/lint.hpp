#pragma once

#include "troupe/simulation.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace troupe {

/// What is odd about a world that can be loaded all the same: everything that its loading warns of, at each
/// place, and
///   - bodies that overlap at the start, robots that stand in walls;
///   - sensors that can never meet anything, floor plans that block no robot;
///   - definitions that nothing uses, properties that change nothing.
/// Each finding is a line `file:line: warning: ...`, in the order of the files and their lines. Of overlaps
/// at most a hundred are listed, the rest is counted. Empty: nothing was found. Throws InputError where the
/// world cannot be loaded.
std::vector<std::string> lint(const std::filesystem::path& world, const SimulationOptions& options = {});

}  // namespace troupe
