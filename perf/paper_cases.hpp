#pragma once

#include "engine/world_spec.hpp"
#include "worldio/load.hpp"
#include "perf/paper_watch.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace troupe::perf {

/// A world to simulate, and for how long.
struct Scene {
  std::string name;  ///< "hospital/2000"; key of the checked-in hash and the paper's figure
  std::filesystem::path world;
  worldio::LoadOptions load;
  std::size_t robots = 0;
  double skip_s = 0;  ///< simulated time before timing starts, s
  double for_s = 60;  ///< simulated time that is timed, s
  bool grid = false;  ///< the paper's ray tracer instead of the exact engine
};

/// One row of a table: a scene, and how it is run.
struct Run {
  Scene scene;
  unsigned threads = 1;
  bool frames = false;  ///< draw a picture every 0.1 s of wall time: the paper's "graphics"
  Watch watch = Watch::nothing;
  std::string simd = {};  ///< instruction set of the kernels; empty: that of the whole report
};

/// Runs that are timed in turn (A B A B ...), so that other load on the machine affects them equally.
struct Case {
  std::string table;  ///< id of their table
  std::vector<Run> runs;
};

/// A world whose loading time and memory are measured in a child process.
struct Child {
  Scene scene;
  bool as_text = false;  ///< load the same robots from .world text
  bool empty = false;    ///< the base for the memory of the others
};

struct Table {
  std::string id;
  std::string title;
  std::string note;
};

/// All measurements to make.
struct Plan {
  std::vector<Table> tables;
  std::vector<Case> cases;
  std::vector<Child> children;
};

/// `quick`: the same kinds of rows with few robots and short times.
/// `threads`: the numbers of threads for rows without pictures; rows with pictures use the first.
/// `simd`: the instruction sets to compare, named as in partition::simd_targets().
Plan make_plan(bool quick, const std::vector<unsigned>& threads, const std::vector<std::string>& simd);

/// The folder with Stage's own worlds, next to the source tree.
std::filesystem::path stage_worlds();

/// The reason why a scene cannot run here; empty if it can.
std::string missing(const Scene& scene);

}  // namespace troupe::perf
