#pragma once

#include "troupe/simulation.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace troupe::apps {

/// How a run went: what the closing summary and --json are made of.
struct Report {
  std::string world;
  std::string title;
  Statistics statistics;
  Simulation::Hashes hashes;
  std::uint64_t first_tick = 0;  ///< where this part of the run began; counters are those since tick 0
  double tick_s = 0;
  double end_s = 0;  ///< where the run was to end, s of world time
  bool stopped = false;
  std::string stopped_by;  ///< the condition of the world with which it was over; empty: it went to end_s
  unsigned threads = 0;
  double load_s = 0;    ///< wall time from the file to the first tick
  double wall_s = 0;    ///< wall time of all ticks, with what watches them (hash log, progress)
  double rate = 0;      ///< times real time, that the run was held back to; 0: it was not
  double waited_s = 0;  ///< part of wall_s in which it was held back
  /// Part of wall_s in each phase; the rest went into watching.
  std::array<double, k_phases> phase_s{};
  double serial_share = 0;  ///< of the ticks' wall time: LoadClock
  double imbalance = 0;     ///< of the workers' load: LoadClock
  std::uint64_t peak_rss_bytes = 0;
  std::string checkpoint;  ///< where the last state was saved; empty: nowhere
  std::vector<std::pair<std::string, std::string>> options;  ///< as they took effect

  /// Ratios are 0 where their denominator is: no ticks, no robots, no measurable time.
  double times_real_time() const;
  double ns_per_robot_tick() const;
  double beams_per_tick() const;
  double observe_s() const;
  std::uint64_t ticks_here() const { return statistics.ticks - first_tick; }
};

/// Aligned lines for people, the last one ended.
std::string summary_text(const Report& report);

/// The same as one flat JSON object, keys in a fixed order, with a line end.
std::string summary_json(const Report& report);

}  // namespace troupe::apps
