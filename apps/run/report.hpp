#pragma once

#include "troupe/simulation.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace troupe::apps {

/// Results of a run, for the closing summary and --json.
struct Report {
  std::string world;
  std::string title;
  Statistics statistics;
  Simulation::Hashes hashes;
  std::uint64_t first_tick = 0;  ///< tick at which the run began or was resumed; counters are since tick 0
  double tick_s = 0;
  double end_s = 0;        ///< requested end, world time, s
  bool stopped = false;    ///< stopped before end_s by a signal or --wall-limit
  std::string stopped_by;  ///< the condition of the world's `stop_when` that ended the run; empty: none
  unsigned threads = 0;
  double load_s = 0;    ///< wall time of loading
  double wall_s = 0;    ///< wall time of all ticks, with the observers (hash log, progress)
  double rate = 0;      ///< limit of the speed, times real time; 0: no limit
  double waited_s = 0;  ///< part of wall_s spent waiting because of `rate`
  /// Part of wall_s in each phase; the rest was spent in observers.
  std::array<double, k_phases> phase_s{};
  double serial_share = 0;  ///< LoadClock::serial_share()
  double imbalance = 0;     ///< LoadClock::imbalance()
  std::uint64_t peak_rss_bytes = 0;
  std::string checkpoint;                                    ///< file with the last state; empty: none
  std::vector<std::pair<std::string, std::string>> options;  ///< effective options

  /// Ratios are 0 if their denominator is 0: no ticks, no robots, no measurable time.
  double times_real_time() const;
  double ns_per_robot_tick() const;
  double beams_per_tick() const;
  double observe_s() const;
  std::uint64_t ticks_here() const { return statistics.ticks - first_tick; }
};

/// The summary as aligned lines; ends with a line break.
std::string summary_text(const Report& report);

/// The summary as one flat JSON object with keys in a fixed order; ends with a line break.
std::string summary_json(const Report& report);

}  // namespace troupe::apps
