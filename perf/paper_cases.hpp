#pragma once

#include "base/result.hpp"
#include "engine/spec/world_spec.hpp"
#include "worldio/load.hpp"
#include "perf/paper_watch.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace troupe::perf {

/// A world to simulate, with its settings and the time to simulate.
struct Scene {
  /// Such as "hospital/2000": a world or a variant of it, and the number of robots. The scene has this name
  /// in perf/paper_hashes.txt, the file with the recorded hashes, and in perf/paper_reference.json, the file
  /// with the speeds of other simulators.
  std::string name;
  std::filesystem::path world;  ///< world file
  worldio::LoadOptions load;
  std::size_t robots = 0;
  double skip_s = 0;  ///< simulated time before the measurement starts, s
  double for_s = 60;  ///< simulated time whose wall time is measured, s
  bool grid = false;  ///< trace rays through the cells of a grid, as Stage does (Vaughan, 2008)
};

/// A scene, and the way in which it is simulated. Each run is a row of a table, except in the table `simd`,
/// where all runs of a case are one row.
struct Run {
  Scene scene;
  unsigned threads = 1;
  /// Draw pictures, at most one per 0.1 s of wall time, as in the runs with graphics of the paper on Stage
  /// (Vaughan, 2008).
  bool frames = false;
  Watch watch = Watch::nothing;
  /// Instruction set of the kernels (vectorised loops); empty: the first that the option --simd names.
  std::string simd = {};
};

/// Runs that are repeated in turn (A B A B ...), so that other load on the machine affects all of them
/// equally.
struct Case {
  std::string table;  ///< id of the table with the rows of these runs
  std::vector<Run> runs;
};

/// A world whose loading time and memory are measured in a child process.
struct Child {
  Scene scene;
  bool as_text = false;  ///< load the robots of the scene from .world text instead of JSON
  bool empty = false;    ///< the world without robots, the baseline for the memory of the others
};

/// A table of the report.
struct Table {
  std::string id;  ///< such as "1" or "clusters"
  std::string title;
  std::string note;
};

/// All measurements to make.
struct Plan {
  std::vector<Table> tables;
  std::vector<Case> cases;
  std::vector<Child> children;
};

/// Plans the measurements that worlds/scenes.json lists. Throws std::runtime_error if that file names an
/// unknown table.
/// quick: plan the same sorts of rows, but with few robots and short times
/// threads: the numbers of threads for rows without pictures; rows with pictures use the first of them
/// simd: the instruction sets to compare, named as in partition::simd_targets()
Plan make_plan(bool quick, const std::vector<unsigned>& threads, const std::vector<std::string>& simd);

/// The folder with the worlds that Stage ships: ../shared/stage-worlds, relative to the root folder of
/// Troupe's sources.
std::filesystem::path stage_worlds();

/// Returns an error if the world file of the scene does not exist.
Result<> has_world(const Scene& scene);

}  // namespace troupe::perf
