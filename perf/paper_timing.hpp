#pragma once

#include "engine/kinds.hpp"
#include "perf/paper_cases.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace troupe::perf {

/// What a run measured.
struct Timing {
  Run run;
  std::size_t robots = 0;
  double tick_s = 0;
  std::uint64_t ticks = 0;      ///< timed, in each repetition
  std::uint64_t hash_tick = 0;  ///< of `hash`: that of the first repetition's end
  std::uint64_t hash = 0;       ///< of the whole state, ranges included
  bool repeatable = true;       ///< every repetition ended with the same hash
  std::vector<double> wall_s;   ///< of each repetition
  double beams_per_tick = 0;
  double rounds_per_tick = 0;  ///< of settling conflicts
  double stalled_share = 0;    ///< of the robots, in the last tick
  double move_share = 0;       ///< of the phases' time; 0 where phases are not timed
  std::size_t frames = 0;      ///< drawn in the last repetition

  /// Wall time of one robot's tick, ns, when a repetition takes `seconds`.
  double ns(double seconds) const;
  /// Simulated time by wall time, when a repetition takes `seconds`.
  double times_real_time(double seconds) const;
};

/// Seconds that each of so many threads needs for the same piece of pure computing, all at once. The
/// machine's own scaling: where nothing is shared, n threads do n times the work in the time of one.
double probe_s(unsigned threads);

struct CaseTiming {
  std::string table;
  std::vector<Timing> timings;
  std::map<unsigned, std::vector<double>> probe_s;  ///< by threads, of each repetition
};

/// Runs a case `repeat` times. A scene that skips time is repeated as consecutive pieces of one run, others
/// from the start. Throws what loading throws, and what drawing throws.
CaseTiming time_case(const Case& one, std::size_t repeat, const engine::Registry& registry,
                     const std::function<void(const std::string&)>& progress);

/// `, frames`, `, hashes`, `, avx2`: what a run is with, for messages; empty where it is plain.
std::string with_text(const Run& run);

/// What looking on takes of the time that the same run takes without: the median over the repetitions. None
/// for a run that nothing looks at.
std::optional<double> watching_cost(const CaseTiming& one, const Timing& watched);

/// Why no pictures can be drawn here; empty when they can.
std::string missing_frames();

double minimum(const std::vector<double>& values);
double median(std::vector<double> values);
double maximum(const std::vector<double>& values);

}  // namespace troupe::perf
