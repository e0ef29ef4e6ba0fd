#pragma once

#include "apps/exit_code.hpp"
#include "troupe/script.hpp"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

/// Options of `troupe sweep`.
struct SweepOptions {
  std::filesystem::path study;   ///< study file, which describes many runs of a world
  std::filesystem::path folder;  ///< folder for the journals (results of finished runs) and the tables
  unsigned runs_at_once = 0;     ///< number of runs that are made in parallel; 0: one per available processor
  std::size_t part = 1;   ///< from 1 to parts: this process makes the runs part - 1, part - 1 + parts, ...
  std::size_t parts = 1;  ///< number of parts (--part)
  double rank_limit_s = 600;  ///< --rank-limit: longest wait for another process, wall time, s
  bool list = false;          ///< only print the list of runs
  bool quiet = false;         ///< print only errors
  std::vector<std::filesystem::path> plugin_path;      ///< folders to search for plug-ins (shared libraries)
  std::vector<std::shared_ptr<const Script>> scripts;  ///< scripts with controllers (--controller)
};

/// Adds the options of `sweep`; parsing fills `options`, which must outlive `command`.
void add_sweep_options(CLI::App& command, SweepOptions& options);

/// `troupe sweep`: makes those runs of a study whose results are not in its folder yet. When all runs are
/// finished, writes the tables. Returns k_finished if the runs of this process are finished, k_failed if a
/// run failed or a file could not be written, and k_stopped after Ctrl-C or SIGTERM. If the output folder
/// cannot be used (OutputError), prints the error and returns k_bad_input. Throws InputError for an invalid
/// study or world; if a launcher such as mpirun started several processes, the first process prints this
/// error instead, and the function returns k_bad_input.
ExitCode sweep(const SweepOptions& options);

}  // namespace troupe::apps
