#pragma once

#include "apps/exit_code.hpp"

#include <cstddef>
#include <filesystem>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

struct SweepOptions {
  std::filesystem::path study;
  std::filesystem::path folder;  ///< journals, and the table
  unsigned runs_at_once = 0;     ///< 0: one for each processor it may use
  std::size_t part = 1;          ///< of `parts`: this process makes every parts-th run
  std::size_t parts = 1;
  bool list = false;  ///< print the runs, and make none
  bool quiet = false;
  std::vector<std::filesystem::path> plugin_path;
};

/// Adds the options of `sweep`; parsing fills `options`, which must outlive `command`.
void add_sweep_options(CLI::App& command, SweepOptions& options);

/// Makes the runs of a study that are not in its folder yet, and the table when all are.
ExitCode sweep(const SweepOptions& options);

}  // namespace troupe::apps
