#pragma once

#include "apps/exit_code.hpp"
#include "apps/run/run_options.hpp"

namespace troupe::apps {

/// `troupe run`: loads, steps to the end, reports. Results go to standard output, everything else to standard
/// error. On bad input nothing is printed on standard output and no file is touched.
ExitCode run(const RunOptions& options);

}  // namespace troupe::apps
