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

/// Measurements of a run.
struct Timing {
  Run run;
  std::size_t robots = 0;
  double tick_s = 0;
  std::uint64_t ticks = 0;      ///< timed ticks in each repetition
  std::uint64_t hash_tick = 0;  ///< tick of `hash`, the end of the first repetition
  std::uint64_t hash = 0;       ///< hash of the whole state, ranges included
  bool repeatable = true;       ///< every repetition ended with the same hash
  std::vector<double> wall_s;   ///< wall time of each repetition
  double beams_per_tick = 0;
  double rounds_per_tick = 0;  ///< rounds of conflict resolution
  double stalled_share = 0;    ///< fraction of robots stalled in the last tick
  double move_share = 0;       ///< fraction of the time of all phases; 0 if phases are not timed
  std::size_t frames = 0;      ///< frames drawn in the last repetition

  /// Wall time per robot and tick, ns, for a repetition of `seconds`.
  double ns(double seconds) const;
  /// Simulated time divided by wall time, for a repetition of `seconds`.
  double times_real_time(double seconds) const;
};

/// Seconds that this number of threads needs, in parallel, for one piece of computing each that uses only
/// registers. Shows how the machine itself scales: ideally n threads do n times the work in the time of one.
double probe_s(unsigned threads);

struct CaseTiming {
  std::string table;
  std::vector<Timing> timings;
  std::map<unsigned, std::vector<double>> probe_s;  ///< by number of threads, for each repetition
};

/// Runs a case `repeat` times. A scene with `skip_s` is repeated as consecutive pieces of one run, others
/// from the start. Throws the errors of loading and drawing.
CaseTiming time_case(const Case& one, std::size_t repeat, const engine::Registry& registry,
                     const std::function<void(const std::string&)>& progress);

/// The special feature of a run for messages: `, frames`, `, hashes`, `, avx2`; empty if it has none.
std::string with_text(const Run& run);

/// Additional time of an observed run relative to the run without observer: the median over the repetitions.
/// Nothing for a run without observer.
std::optional<double> watching_cost(const CaseTiming& one, const Timing& watched);

/// The reason why no pictures can be drawn here; empty if they can.
std::string missing_frames();

double minimum(const std::vector<double>& values);
double median(std::vector<double> values);
double maximum(const std::vector<double>& values);

}  // namespace troupe::perf
