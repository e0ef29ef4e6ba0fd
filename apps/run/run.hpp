#pragma once

#include "apps/exit_code.hpp"
#include "apps/run/run_options.hpp"

namespace troupe::apps {

/// `troupe run` and `troupe resume`: loads the worlds, steps them to their ends and prints summaries. Results
/// go to standard output, everything else to standard error.
///
/// - Returns k_finished if all worlds have reached their ends, and k_stopped if a signal or --wall-limit
///   stopped a run early.
/// - If the input is invalid, or if an output file must not or cannot be written, prints an error and returns
///   k_bad_input. It then writes neither to standard output nor to a file.
/// - A run with --session repeats the actions that users performed in a session of `troupe view`. If an
///   action is impossible, prints an error and returns k_failed.
/// - If writing an output fails during a run, saves the checkpoints that the options request, and throws. A
///   checkpoint is a file from which a run can be resumed.
/// - If a simulation step fails, throws. It saves no checkpoint of the run that failed.
ExitCode run(const RunOptions& options);

}  // namespace troupe::apps
