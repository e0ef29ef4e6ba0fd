#pragma once

#include "engine/kinds/registry.hpp"
#include "perf/paper_cases.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace troupe::perf {

/// Measurements of a child process that loads one world and runs it for some ticks (time steps).
struct ChildReport {
  std::size_t robots = 0;
  double read_s = 0;       ///< wall time to read the file, s
  double build_s = 0;      ///< wall time to build the world from its description, s
  double rss_bytes = 0;    ///< resident memory after the last tick
  double peak_bytes = 0;   ///< peak resident memory
  std::uint64_t tick = 0;  ///< the last tick
  std::uint64_t hash = 0;  ///< hash of the whole state after the last tick
};

/// The measurements of all repetitions of a child.
struct ChildTiming {
  Child child;
  std::vector<ChildReport> reports;  ///< one per repetition
};

/// Runs in the child process: loads and simulates `scene`, and prints the ChildReport as JSON on standard
/// output. Throws InputError if the world cannot be loaded, and std::runtime_error if the memory use is
/// unknown.
void report_child(const Scene& scene, const engine::Registry& registry);

/// Measures a child in the parent process: starts this program `repeat` times with `arguments`, and reads the
/// report that each child process prints. `arguments` must include `--child INDEX`, where INDEX is the index
/// of the child in Plan::children. Throws std::runtime_error if a child process fails.
ChildTiming time_child(const Child& child, const std::vector<std::string>& arguments, std::size_t repeat);

/// Writes a world to `file` in Stage's .world syntax: the floor plan of the hospital, and one line per robot.
/// The robots are those of the JSON world of the scene, at the same poses. They all get the type `minibot`, a
/// small robot with 12 infrared sensors. Throws InputError if the JSON world cannot be loaded, and
/// std::runtime_error if the file cannot be written.
void write_as_text(const Scene& scene, const std::filesystem::path& file, const engine::Registry& registry);

}  // namespace troupe::perf
