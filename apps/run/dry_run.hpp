#pragma once

#include "apps/run/report.hpp"
#include "engine/ranks/halo.hpp"
#include "troupe/simulation.hpp"

#include <cstdint>
#include <string>

namespace troupe::apps {

/// What a run would need, for the option --dry-run: its length in ticks (simulation steps), its memory, and
/// how its bodies would be divided among the ranks, which are processes, or groups of threads, that compute
/// the world together. A row is the entry of a body in the state tables. The region of a rank is the part of
/// the world whose bodies the rank computes; the rows of these bodies are its own rows. A ghost is a copy of
/// a row of another rank. The neighbours of a rank are the ranks that own its ghosts or have ghosts of its
/// own rows (engine/ranks/halo.hpp).
struct DryRun {
  std::string world;              ///< name of the world file
  std::size_t robots = 0;         ///< robots in the world
  std::size_t rows = 0;           ///< bodies with a drive, a sensor, a device or a controller
  std::uint64_t ticks = 0;        ///< ticks of the run
  double end_s = 0;               ///< end of the run, simulated time, s
  std::uint64_t world_bytes = 0;  ///< resident memory of this process, which has loaded the whole world
  std::uint64_t state_bytes = 0;  ///< memory of the state tables of the whole world
  unsigned ranks = 1;             ///< number of ranks that would compute the world
  bool is_distributed = false;    ///< each rank would have only its own rows and ghosts
  std::string why_replicated;     ///< why the world would not be distributed (RankStatistics); or empty
  double longest_motion_m = 0;    ///< motion in one tick at the highest speed limit of any drive, m
  double coverage_m = 0;          ///< a rank has ghosts of bodies up to this distance from its region, m
  /// Numbers of own rows, ghosts and neighbours per rank: the mean over the ranks, and the largest. If the
  /// world is not distributed, the rows are divided evenly, and there are neither ghosts nor neighbours.
  Report::PerRank own, ghosts, neighbours;
  double most_rows = 0;  ///< own rows and ghosts of the rank that has the most, if distributed
  /// Memory of the state tables of the rows that a rank has, bytes.
  Report::PerRank rank_state_bytes() const;
};

/// Returns what the run of a loaded world would need. simulation: the loaded world, which must be computed by
/// one rank; report: the report of the run, with the members that are known before the first tick; ranks:
/// number of ranks of the run; distribute: the option --distribute
DryRun dry_run_of(const Simulation& simulation, const Report& report, unsigned ranks, bool distribute);

/// Returns the lines that --dry-run prints below the options of the run; ends with a line break.
std::string dry_run_text(const DryRun& run);
/// Returns the results as one JSON object without nested objects; ends with a line break.
std::string dry_run_json(const DryRun& run);

}  // namespace troupe::apps
