#pragma once

#include "apps/exit_code.hpp"
#include "apps/run/run_options.hpp"

namespace troupe::apps {

/// `troupe run` and `troupe resume`: loads the worlds, steps them to their ends and prints summaries. Results
/// go to standard output, everything else to standard error. On bad input nothing is printed on standard
/// output and no file is written.
ExitCode run(const RunOptions& options);

}  // namespace troupe::apps
