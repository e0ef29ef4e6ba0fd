#pragma once

#include "base/result.hpp"
#include "engine/kinds/registry.hpp"
#include "perf/paper_cases.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace troupe::perf {

/// Measurements of a run. A tick is a time step. Members have the values of the last repetition, unless
/// their comments say otherwise.
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
  std::size_t frames = 0;      ///< pictures drawn in the last repetition

  /// Wall time per robot and tick, ns, for a repetition that took `seconds` of wall time.
  double ns(double seconds) const;
  /// Simulated time divided by wall time, for a repetition that took `seconds` of wall time.
  double times_real_time(double seconds) const;
};

/// Measures how the machine itself scales. Runs the same computation on `threads` threads in parallel, the
/// calling thread included, and returns the wall time, s. The computation uses only registers, so the threads
/// share no data. On an ideal machine, the result is the same for any number of threads.
double probe_s(unsigned threads);

struct CaseTiming {
  std::string table;            ///< id of the table with the rows of these runs
  std::vector<Timing> timings;  ///< one per run of the case, in the same order
  /// Results of probe_s(): number of threads -> one value per repetition.
  std::map<unsigned, std::vector<double>> probe_s;
};

/// Measures a case: each of its runs `repeat` times. Usually, each repetition starts at tick 0. If the scene
/// has a skip_s above 0, the simulation runs for skip_s once, and the repetitions then follow one another in
/// the same simulation.
///
/// progress: called before each measurement with a text that names it. Throws InputError if a world cannot be
/// loaded, and std::runtime_error if pictures cannot be drawn or recordings cannot be written.
CaseTiming time_case(const Case& one, std::size_t repeat, const engine::Registry& registry,
                     const std::function<void(const std::string&)>& progress);

/// Returns a text that describes a run in a message: ", frames" for a run with pictures, otherwise ", " and
/// the name of its instruction set or of its observer, as in ", avx2" or ", hashes". The text is empty for a
/// run without pictures, with the default instruction set and without an observer.
std::string with_text(const Run& run);

/// Returns the cost of an observer, which is code that reads the state after every tick. The cost is the
/// additional wall time of the run `watched` compared with a run without an observer, as a fraction of the
/// time of that run. For example, 0.05 means 5 % more time. The result is the median over the repetitions.
///
/// The run without an observer is taken from the same case `one`, with the same number of threads. The result
/// is empty if there is no such run, or if `watched` has no observer.
std::optional<double> watching_cost(const CaseTiming& one, const Timing& watched);

/// Returns an error, with the reason, if pictures cannot be drawn.
Result<> can_draw();

double minimum(const std::vector<double>& values);
double median(std::vector<double> values);
double maximum(const std::vector<double>& values);

}  // namespace troupe::perf
