#pragma once

#include "apps/exit_code.hpp"
#include "apps/run/run_options.hpp"

namespace troupe::apps {

/// `troupe run` and `troupe resume`: loads the worlds, steps them to their ends and prints summaries. Results
/// go to standard output, everything else to standard error. On bad input, prints an error, returns
/// k_bad_input, and writes neither to standard output nor to a file. Returns k_stopped if a run was stopped
/// early by a signal or --wall-limit. If the run repeats a session (--session) and an action of a user in it
/// is impossible, prints an error and returns k_failed. If writing an output fails, saves the checkpoints
/// (states from which the runs can be resumed) that the options request and throws. If a simulation step
/// fails, throws without saving the checkpoint of that run.
ExitCode run(const RunOptions& options);

}  // namespace troupe::apps
