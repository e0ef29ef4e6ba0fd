#pragma once

#include "engine/world_spec.hpp"
#include "worldio/load.hpp"
#include "perf/paper_watch.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace troupe::perf {

/// What is simulated, for how long.
struct Scene {
  std::string name;  ///< "hospital/2000": under it stand the checked-in hash and the paper's figure
  std::filesystem::path world;
  worldio::LoadOptions load;
  std::size_t robots = 0;
  double skip_s = 0;  ///< simulated before the clock starts
  double for_s = 60;  ///< simulated while it runs
  bool grid = false;  ///< the paper's ray tracer instead of the exact engine
};

/// One line of a table: a scene, and how it is run.
struct Run {
  Scene scene;
  unsigned threads = 1;
  bool frames = false;  ///< a picture every 0.1 s of wall time: the paper's "graphics"
  Watch watch = Watch::nothing;
  std::string simd = {};  ///< instruction set of the kernels, where it is not the whole report's
};

/// Runs that are timed in turn (A B A B ...), so that what else the machine does meets them alike.
struct Case {
  std::string table;  ///< id of the table whose lines they are
  std::vector<Run> runs;
};

/// A world whose loading and memory are measured, in a process of its own.
struct Child {
  Scene scene;
  bool as_text = false;  ///< the same robots, written as .world text first
  bool empty = false;    ///< what the others' memory is compared with
};

struct Table {
  std::string id;
  std::string title;
  std::string note;
};

/// Everything that is measured.
struct Plan {
  std::vector<Table> tables;
  std::vector<Case> cases;
  std::vector<Child> children;
};

/// quick: the same kinds of rows with few robots and short times.
/// threads: the numbers of threads that rows without pictures are run with; those with pictures take the
/// first.
/// simd: the instruction sets that are compared, by the names of partition::simd_targets().
Plan make_plan(bool quick, const std::vector<unsigned>& threads, const std::vector<std::string>& simd);

/// Where Stage's own worlds are looked for: beside the source tree.
std::filesystem::path stage_worlds();

/// Why a scene cannot run here; empty when it can.
std::string missing(const Scene& scene);

}  // namespace troupe::perf
