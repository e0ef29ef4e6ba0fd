#pragma once

#include "apps/run/report.hpp"
#include "engine/ranks/halo.hpp"
#include "troupe/simulation.hpp"

#include <cstdint>
#include <string>

namespace troupe::apps {

/// What a run would need, as the option --dry-run prints it. Ranks are processes, or groups of threads, that
/// compute the world together. A tick is a time step. A row is the entry of a body in the state tables.
///
/// A world is *distributed* if each rank has only some of the rows. Each rank then has a region of the world,
/// and owns the rows of the bodies in this region: its own rows. A ghost is a copy of a row that another rank
/// owns. If the world is not distributed, each rank has all rows, and computes an equal part of them: its own
/// rows.
struct DryRun {
  std::string world;              ///< name of the world file
  std::size_t robots = 0;         ///< robots in the world
  std::size_t rows = 0;           ///< one row per body with a drive, sensor, device or controller
  std::uint64_t ticks = 0;        ///< ticks of the run
  double end_s = 0;               ///< end of the run, simulated time, s
  std::uint64_t world_bytes = 0;  ///< memory of this process in RAM, with the whole world, bytes
  std::uint64_t state_bytes = 0;  ///< memory of the state tables of the whole world, bytes
  unsigned ranks = 1;             ///< number of ranks that would compute the world
  bool is_distributed = false;    ///< whether the world would be distributed
  std::string why_replicated;     ///< why --distribute is not possible; empty if possible or not given
  double longest_motion_m = 0;    ///< motion in a tick at the highest speed limit, m; 0 if not distributed
  double coverage_m = 0;          ///< ghosts are up to this distance from the region, m; 0 if not distributed
  /// Numbers of own rows, of ghosts and of neighbours of a rank: the mean over the ranks, and the largest.
  /// The neighbours of a rank are the ranks that own its ghosts or have ghosts of its own rows. Ghosts and
  /// neighbours are 0 if the world is not distributed.
  Report::PerRank own, ghosts, neighbours;
  double most_rows = 0;  ///< largest number of own rows and ghosts of a rank; 0 if not distributed
  /// Returns the memory of the state tables on a rank, bytes: the mean over the ranks, and the largest. It
  /// includes all rows that the rank has: own rows and ghosts, or, if the world is not distributed, all rows
  /// of the world.
  Report::PerRank rank_state_bytes() const;
};

/// Returns what the run of a loaded world would need.
///
/// simulation: the loaded world, which must be computed by one rank
/// report: the members `world`, `first_tick`, `tick_s` and `end_s` are used
/// ranks: number of ranks of the run
/// distribute: whether the option --distribute is given
DryRun dry_run_of(const Simulation& simulation, const Report& report, unsigned ranks, bool distribute);

/// Returns the lines of text that --dry-run prints below the options of the run. The text ends with a line
/// break.
std::string dry_run_text(const DryRun& run);
/// Returns the data of `run` as one JSON object without nested objects, followed by a line break.
std::string dry_run_json(const DryRun& run);

}  // namespace troupe::apps
