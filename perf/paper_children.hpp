#pragma once

#include "engine/kinds/kinds.hpp"
#include "perf/paper_cases.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace troupe::perf {

/// Measurements of a child process that loads one world and runs it for some ticks (simulation steps).
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

/// Called in the child process: loads and runs `scene`, and prints the ChildReport as JSON on standard
/// output. Throws InputError if the world cannot be loaded, and std::runtime_error if the memory use is
/// unknown.
void report_child(const Scene& scene, const engine::Registry& registry);

/// Called in the parent process: starts this program `repeat` times with `arguments`, which include
/// `--child INDEX`, and reads the reports of the children. Throws std::runtime_error if a child fails.
ChildTiming time_child(const Child& child, const std::vector<std::string>& arguments, std::size_t repeat);

/// Writes a hospital with robots to `file` as .world text, one line per model. For each robot in the JSON
/// world of the scene, the file has a model of the type `minibot` at the same pose. Throws InputError if the
/// JSON world cannot be loaded, and std::runtime_error if the file cannot be written.
void write_as_text(const Scene& scene, const std::filesystem::path& file, const engine::Registry& registry);

}  // namespace troupe::perf
