#pragma once

#include "apps/exit_code.hpp"
#include "apps/options.hpp"

#include <cstddef>
#include <filesystem>

namespace troupe::apps {

/// Options of `troupe sweep`. The runs of a study can be divided into parts (--part), each of which one
/// process makes.
struct SweepOptions {
  std::filesystem::path study;   ///< study file, which describes many runs of a world
  std::filesystem::path folder;  ///< folder for the journals (results of finished runs) and the tables
  unsigned runs_at_once = 0;     ///< number of runs that are made in parallel; 0: one per available processor
  std::size_t part = 1;   ///< from 1 to parts: this process makes the runs part - 1, part - 1 + parts, ...
  std::size_t parts = 1;  ///< number of parts
  double rank_limit_s = 600;  ///< --rank-limit: longest wait for another process, wall time, s
  bool list = false;          ///< only print the list of runs
  bool quiet = false;         ///< print only errors
  KindSources sources;        ///< plug-ins and scripts with kinds that the study or its world names
};

/// Adds the options of `sweep` to `command`. Parsing fills `options`, which must outlive `command`.
void add_sweep_options(CLI::App& command, SweepOptions& options);

/// `troupe sweep`: makes the runs of a study, or of one part of it (--part), whose results are not yet in the
/// output folder. When all runs of the study have ended, writes the tables.
///
/// - Returns k_finished if all runs of this process are finished.
/// - Returns k_failed if a run failed, if a table could not be written, or if results are missing in the
///   folder.
/// - Returns k_stopped after Ctrl-C, SIGTERM or SIGHUP.
/// - Returns k_bad_input, after printing an error, if the output folder cannot be used.
/// - Throws InputError for an invalid study or world, and std::runtime_error if a result cannot be written.
///
/// If a launcher such as mpirun started several processes, they share the runs. The first process then
/// returns the value for the runs of all processes. It does not throw InputError, but prints the error and
/// returns k_bad_input.
ExitCode sweep(const SweepOptions& options);

}  // namespace troupe::apps
