#pragma once

#include "troupe/simulation.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace troupe::apps {

/// Results of a run, from which summary_text() and summary_json() make the summary. A tick is a
/// time step; a phase is a part of a tick, such as sense or move. Observers are objects that read the
/// state after each tick, for example to write a file.
///
/// Several ranks can compute a world together; a rank is a process or a group of threads. The own bodies of a
/// rank are the bodies that the rank computes itself. Its ghosts are its copies of bodies of other ranks.
struct Report {
  std::string world;             ///< name of the world file
  std::string title;             ///< title of the world
  Statistics statistics;         ///< ticks, robots, ... at the end of the run; counters begin at tick 0
  Simulation::Hashes hashes;     ///< hashes of the state at the end of the run
  std::uint64_t first_tick = 0;  ///< tick at which the run began or was resumed
  double tick_s = 0;             ///< length of a tick, s
  double end_s = 0;              ///< requested end, simulated time, s
  bool stopped = false;          ///< stopped before end_s by a signal or --wall-limit
  std::string stopped_by;        ///< the condition of the world's `stop_when` that ended the run; empty: none
  unsigned threads = 0;          ///< worker threads per rank
  /// Statistics of the ranks in this run, such as the number of messages that rank 0 sent to other ranks.
  RankStatistics ranks;
  /// One entry per rank; empty with one rank. An entry has the numbers of own bodies, ghosts, messages and so
  /// on, each summed over the ticks of this run.
  std::vector<RankCounts> rank_counts;
  double load_s = 0;    ///< wall time of loading the world, s
  double wall_s = 0;    ///< wall time of all ticks, including the observers, s
  double rate = 0;      ///< limit of the speed, in multiples of real time; 0: none
  double waited_s = 0;  ///< part of wall_s that was spent waiting because of `rate`, s
  /// Wall time of each phase, summed over all ticks, s; indexed by Phase. The rest of `wall_s` was spent in
  /// observers (observe_s()) or waiting because of `rate` (waited_s).
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

  /// Subtracts the counts in `before` from `rank_counts`, so that only the counts of this run remain.
  ///
  /// before: the counts of each rank at the beginning of this run, in the order of `rank_counts`
  void subtract_counts(std::span<const RankCounts> before);
  /// The mean over the ranks and the largest value on any rank, for a number that may differ between ranks.
  struct PerRank {
    double mean = 0;
    double most = 0;
    /// Returns `most` divided by `mean`: 1 if all ranks have the same value; 0 if the mean is 0.
    double imbalance() const;
  };
  /// Divides a count of each rank by the number of ticks, and returns the mean and the largest value of the
  /// quotient over the ranks. For example, per_rank(&RankCounts::messages) is about the number of messages
  /// that a rank sends per tick.
  PerRank per_rank(std::uint64_t RankCounts::*count) const;
  /// Returns the mean number of ghosts per own body: the sum of all ghosts divided by the sum of all own
  /// bodies, both over all ranks and ticks.
  double ghosts_per_own() const;

  double observe_s() const;  ///< part of wall_s that was spent in observers, s
  /// Number of ticks of this run. If the run was resumed, earlier ticks are not counted.
  std::uint64_t ticks_here() const { return statistics.ticks - first_tick; }
};

/// Returns the summary as text: one line per value, with the name and the value in two columns. The text ends
/// with a line break.
std::string summary_text(const Report& report);

/// Returns the summary as one line of text, which ends with a line break: a JSON object without nested
/// objects. Its keys have a fixed order.
std::string summary_json(const Report& report);

}  // namespace troupe::apps
