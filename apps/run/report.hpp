#pragma once

#include "troupe/simulation.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace troupe::apps {

/// Results of a run. World time is simulated time, a tick is a simulation step, and a phase is a part of a
/// tick, such as sense or move. At the end of the run, summary_text() or, with --json, summary_json() makes
/// the summary from these results.
struct Report {
  std::string world;             ///< name of the world file
  std::string title;             ///< title of the world
  Statistics statistics;         ///< robots, stalls, ... at the end of the run; counts since tick 0
  Simulation::Hashes hashes;     ///< hashes of the state at the end of the run
  std::uint64_t first_tick = 0;  ///< tick at which the run began or was resumed
  double tick_s = 0;             ///< length of a tick, s
  double end_s = 0;              ///< requested end, world time, s
  bool stopped = false;          ///< stopped before end_s by a signal or --wall-limit
  std::string stopped_by;        ///< the condition of the world's `stop_when` that ended the run; empty: none
  unsigned threads = 0;          ///< worker threads per rank
  /// Statistics of the ranks in this run, such as the messages that rank 0 sent and the time that rank 0
  /// waited. Ranks are processes, or groups of threads, that compute the world together.
  RankStatistics ranks;
  /// One entry per rank: the messages that it sent, the bodies that it computed itself (its own bodies) and
  /// so on, each summed over the ticks of this run. Empty with one rank.
  std::vector<RankCounts> rank_counts;
  double load_s = 0;    ///< wall time of loading the world, s
  double wall_s = 0;    ///< wall time of all ticks, including the observers (hash log, ...), s
  double rate = 0;      ///< limit of the speed, in multiples of real time; 0: none
  double waited_s = 0;  ///< part of wall_s that was spent waiting because of `rate`, s
  /// Part of wall_s that each phase took, s. The rest was spent waiting and in observers.
  std::array<double, k_phases> phase_s{};
  double serial_share = 0;  ///< fraction of the time of ticks outside parallel loops, 0 to 1 (LoadClock)
  double imbalance = 0;     ///< how unevenly the threads were loaded; 1: evenly (LoadClock::imbalance())
  std::uint64_t peak_rss_bytes = 0;  ///< largest resident memory of the process, bytes
  std::string checkpoint;            ///< file with the last state; empty: none
  std::vector<std::pair<std::string, std::string>> options;  ///< all options of the run: names, values

  // The following ratios are 0 if their denominator is 0: no ticks, no robots, no measurable time.
  double times_real_time() const;    ///< simulated time of this run divided by wall_s
  double ns_per_robot_tick() const;  ///< wall time without waiting, per robot and tick, ns
  double beams_per_tick() const;     ///< mean number of beams per tick, since tick 0
  double bytes_per_tick() const;     ///< mean number of bytes that rank 0 sent to other ranks per tick
  double messages_per_tick() const;  ///< mean number of messages that rank 0 sent to other ranks per tick

  /// Subtracts `before`, the counts of the ranks at the beginning of this run, from `rank_counts`. before:
  /// one entry per rank
  void subtract_counts(std::span<const RankCounts> before);
  /// A number that may differ between ranks, such as a count per tick: its mean over the ranks, and its
  /// largest value on any rank.
  struct PerRank {
    double mean = 0;
    double most = 0;
    /// `most` divided by `mean`, 1 if all ranks have the same value; 0 if the mean is 0.
    double imbalance() const;
  };
  /// Mean and largest value, over the ranks, of the member `count` of `rank_counts` divided by the number of
  /// ticks.
  PerRank per_rank(std::uint64_t RankCounts::*count) const;
  /// Mean number of ghosts per own body. A ghost is a copy that a rank has of a body of another rank; an own
  /// body of a rank is a body that the rank computes itself. The result is the number of ghosts of all ranks
  /// divided by the number of own bodies of all ranks, both averaged over the ticks.
  double ghosts_per_own() const;

  double observe_s() const;  ///< part of wall_s that was spent in observers, s
  /// Number of ticks of this run, without those before it was resumed.
  std::uint64_t ticks_here() const { return statistics.ticks - first_tick; }
};

/// Returns the summary as lines of names and values in two columns; ends with a line break.
std::string summary_text(const Report& report);

/// Returns the summary as one JSON object without nested objects, with keys in a fixed order; ends with a
/// line break.
std::string summary_json(const Report& report);

}  // namespace troupe::apps
