#pragma once

namespace troupe::apps {

/// What the program returns to its caller.
enum ExitCode : int {
  k_finished = 0,
  k_failed = 1,     ///< the run, or writing its results, went wrong; bits differ; or a lint found something
  k_bad_input = 2,  ///< wrong world or usage; nothing was written
  k_stopped = 3,    ///< ended early by Ctrl-C or SIGTERM, results written
};

}  // namespace troupe::apps
