#pragma once

#include "base/result.hpp"
#include "engine/kinds/kinds.hpp"
#include "perf/paper_cases.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace troupe::perf {

/// Measurements of a run. A tick is a simulation step. Members whose comments do not mention repetitions hold
/// values of the last repetition.
struct Timing {
  Run run;
  std::size_t robots = 0;
  double tick_s = 0;            ///< length of a tick, s
  std::uint64_t ticks = 0;      ///< measured ticks in each repetition
  std::uint64_t hash_tick = 0;  ///< the tick at which `hash` is computed: the end of the first repetition
  std::uint64_t hash = 0;       ///< hash of the whole state, range readings included, in the first repetition
  bool repeatable = true;       ///< false if another repetition had a different hash at hash_tick
  std::vector<double> wall_s;   ///< wall time of each repetition, s
  double beams_per_tick = 0;
  double rounds_per_tick = 0;  ///< mean number of rounds in which conflicting motions are resolved
  double stalled_share = 0;    ///< fraction of robots stalled in the last tick
  double move_share = 0;       ///< fraction of the wall time spent moving robots; 0 if not measured
  std::size_t frames = 0;      ///< frames drawn in the last repetition

  /// Wall time per robot and tick, ns, for a repetition that took `seconds` of wall time.
  double ns(double seconds) const;
  /// Simulated time divided by wall time, for a repetition that took `seconds` of wall time.
  double times_real_time(double seconds) const;
};

/// Runs the same computation on `threads` threads in parallel, the calling thread included, and returns the
/// wall time, s. The computation uses only registers, so that the threads share nothing. The result shows how
/// the machine itself scales: ideally n threads take the same time as one.
double probe_s(unsigned threads);

/// Measurements of a case.
struct CaseTiming {
  std::string table;            ///< id of the table with the rows of these runs
  std::vector<Timing> timings;  ///< one per run of the case, in their order
  /// Results of probe_s(): number of threads -> one value per repetition.
  std::map<unsigned, std::vector<double>> probe_s;
};

/// Measures a case `repeat` times. The repetitions of a scene with skip_s above 0 are consecutive pieces of
/// one simulation; those of other scenes each start at tick 0. progress: called before each measurement with
/// a text that names the measurement. Throws InputError if a world cannot be loaded, and std::runtime_error
/// if pictures cannot be drawn.
CaseTiming time_case(const Case& one, std::size_t repeat, const engine::Registry& registry,
                     const std::function<void(const std::string&)>& progress);

/// The end of a message that says how a run differs from the plain run of its scene: `, frames` if the run
/// draws frames; otherwise a comma and the name of its observer (`, hashes`) or of its instruction set
/// (`, avx2`). Empty for a plain run.
std::string with_text(const Run& run);

/// Returns the cost of an observer: the additional wall time of the run `watched`, as a fraction of the wall
/// time without the observer. An observer reads the state after every tick, for example to record it. The run
/// without an observer is that of the same case with as many threads. The cost is the median over the
/// repetitions. Empty if `watched` has no observer or the case has no such run.
std::optional<double> watching_cost(const CaseTiming& one, const Timing& watched);

/// Returns an error, with the reason, if pictures cannot be drawn.
Result<> can_draw();

double minimum(const std::vector<double>& values);
double median(std::vector<double> values);
double maximum(const std::vector<double>& values);

}  // namespace troupe::perf
