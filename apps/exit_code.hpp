#pragma once

namespace troupe::apps {

/// Exit codes of the program.
enum ExitCode : int {
  k_finished = 0,   ///< the command succeeded
  k_failed = 1,     ///< the run or writing its results failed, compared results differ, or lint has findings
  k_bad_input = 2,  ///< invalid world, usage or output file; the run has not begun and nothing was written
  k_stopped = 3,    ///< stopped early by Ctrl-C, SIGTERM, SIGHUP or --wall-limit; results were written
};

}  // namespace troupe::apps
