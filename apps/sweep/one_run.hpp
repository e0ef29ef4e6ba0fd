#pragma once

#include "apps/sweep/journal.hpp"
#include "apps/sweep/sweep.hpp"
#include "troupe/simulation.hpp"
#include "worldio/json/study.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace troupe::apps {

/// Returns the options with which a run of a study is made.
SimulationOptions simulation_options(const worldio::Study& study, const worldio::Study::Run& run,
                                     const SweepOptions& options);
/// Returns the end of a run in simulated time, s. Throws InputError if neither the study nor the world has
/// one.
double end_time_s(const worldio::Study& study, const Simulation& simulation);

/// The results of a run.
struct MadeRun {
  SweepOutcome outcome;
  std::string series;  ///< the rows of the run in series.csv; empty if the study has no series
};
/// Makes one run and returns its results; std::nullopt if Ctrl-C, SIGTERM or SIGHUP stopped the run. index:
/// index of the run in the study. columns: names of the measures in the tables
std::optional<MadeRun> make_run(const worldio::Study& study, std::size_t index,
                                const std::vector<std::string>& columns, const SweepOptions& options);

}  // namespace troupe::apps
