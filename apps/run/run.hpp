#pragma once

#include "apps/exit_code.hpp"
#include "apps/run/run_options.hpp"

namespace troupe::apps {

/// `troupe run` and `troupe resume`: loads the worlds, steps them to their ends and prints summaries. Results
/// go to standard output, everything else to standard error. On bad input, prints an error, returns
/// k_bad_input, and writes neither to standard output nor to a file. Returns k_stopped if a run was stopped
/// early by a signal or --wall-limit. If writing an output fails, saves the checkpoints that the options
/// request and throws; if a step fails, throws without saving them.
ExitCode run(const RunOptions& options);

}  // namespace troupe::apps
