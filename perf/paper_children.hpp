#pragma once

#include "engine/kinds.hpp"
#include "perf/paper_cases.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace troupe::perf {

/// What a process that loads one world and runs it for some ticks says of itself.
struct ChildReport {
  std::size_t robots = 0;
  double read_s = 0;       ///< from the file to what it describes
  double build_s = 0;      ///< from there to a world that can step
  double rss_bytes = 0;    ///< resident after the last tick
  double peak_bytes = 0;   ///< most that was resident
  std::uint64_t tick = 0;  ///< the last
  std::uint64_t hash = 0;  ///< of the whole state, after it
};

struct ChildTiming {
  Child child;
  std::vector<ChildReport> reports;  ///< one a repetition
};

/// In the child: loads `scene`, runs it, and prints the report on standard output.
void report_child(const Scene& scene, const engine::Registry& registry);

/// In the parent: starts this program `repeat` times with `--child INDEX` and what else is given, and
/// reads the reports. Throws std::runtime_error when a child fails.
ChildTiming time_child(const Child& child, const std::vector<std::string>& arguments, std::size_t repeat);

/// Writes the robots of a JSON world as .world text, a model a line. Throws what loading throws.
void write_as_text(const Scene& scene, const std::filesystem::path& file, const engine::Registry& registry);

}  // namespace troupe::perf
