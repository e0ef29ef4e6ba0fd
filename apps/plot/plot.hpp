#pragma once

#include "apps/exit_code.hpp"

#include <filesystem>
#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

/// Options of `troupe plot`. Empty options are not passed to python/troupe/plot.py, which has defaults.
struct PlotOptions {
  std::filesystem::path folder;  ///< folder with the results of a sweep
  std::string measure;           ///< name of the measure
  std::string by;                ///< parameters whose values distinguish the lines of the plot: "A,B"
  std::string title;             ///< title above the plot
  std::filesystem::path out;     ///< picture to write
};

/// Adds the options of `plot`; parsing fills `options`, which must outlive `command`.
void add_plot_options(CLI::App& command, PlotOptions& options);
/// `troupe plot`: plots a measure of a sweep. Replaces the process by Python (the interpreter that the
/// environment variable TROUPE_PYTHON names, else python3), which runs the script plot.py that is embedded in
/// this program. If Python cannot be started, prints an error and returns k_failed; otherwise does not
/// return.
ExitCode plot(const PlotOptions& options);

}  // namespace troupe::apps
