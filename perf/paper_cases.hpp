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
  /// Name of the scene, such as "hospital/2000": the name of the world or of a variant of it, a slash, and
  /// the number of robots. The files perf/paper_hashes.txt (recorded hashes) and perf/paper_reference.json
  /// (speeds of other simulators) refer to scenes by this name.
  std::string name;
  std::filesystem::path world;  ///< world file
  worldio::LoadOptions load;
  std::size_t robots = 0;
  double skip_s = 0;  ///< simulated time before the measurement starts, s
  double for_s = 60;  ///< simulated time whose wall time is measured, s
  bool grid = false;  ///< trace rays through the cells of a grid, as Stage does; false: exact rays
};

/// A scene, and the way in which it is simulated. The report has one row per run. In the table `simd`, one
/// row shows all runs of a case.
struct Run {
  Scene scene;
  unsigned threads = 1;
  /// If true, pictures are drawn during the run, at most one per 0.1 s of wall time. The paper on Stage
  /// (Vaughan, 2008) measures such runs.
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
  bool empty = false;    ///< the scene without robots, with whose memory use the others are compared
};

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
///
/// quick    if true, plan few robots and short times, in the same tables
/// threads  numbers of threads; most scenes are measured with each of them. Runs with pictures use only the
///          first number
/// simd     the instruction sets to compare, named as in partition::simd_targets()
Plan make_plan(bool quick, const std::vector<unsigned>& threads, const std::vector<std::string>& simd);

/// Returns the folder with the worlds that Stage ships: ../shared/stage-worlds, relative to the root folder
/// of Troupe's sources.
std::filesystem::path stage_worlds();

/// Returns an error if the world file of the scene does not exist.
Result<> has_world(const Scene& scene);

}  // namespace troupe::perf
