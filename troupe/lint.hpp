#pragma once

#include "troupe/simulation.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace troupe {

/// Finds probable mistakes in a world that can be loaded. Returns one line per finding,
/// `file:line: warning: ...`, in the order of files and lines, and then the warnings about plug-ins (shared
/// libraries with controllers or devices). The list is empty if there are no findings. Throws InputError if
/// the world cannot be loaded, as the constructor of Simulation does, and for errors in the measures and the
/// recording that the world asks for.
///
/// The findings are the warnings that loading the world gives, and:
/// - bodies that overlap at the start, and robots that start inside walls;
/// - sensors that can never detect anything;
/// - floor plans (walls from an image, a ROS map or a list of points) that block no robot;
/// - drives that cannot stand still, drives and devices that never run, power packs that can hold no energy,
///   and power contacts that exchange none;
/// - controllers that react to obstacles beyond the range of their ranger, or whose goals are out of bounds;
/// - conditions in `stop_when` that do not have the parameters which the list `measures` gives their measure;
/// - unused definitions, and properties, interventions and faults without effect.
///
/// At most 100 overlaps of bodies are listed, and at most 100 robots that start inside walls of a floor plan
/// that is no obstacle. If there are more, a further line states how many more.
std::vector<std::string> lint(const std::filesystem::path& world, const SimulationOptions& options = {});

}  // namespace troupe
