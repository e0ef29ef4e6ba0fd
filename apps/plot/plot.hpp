#pragma once

#include "apps/cli_app.hpp"
#include "apps/exit_code.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace troupe::apps {

/// Options of `troupe plot`, which plots a measure (a number computed from the state) over time or over a
/// parameter. The data are results of `troupe sweep`, which runs a world many times with different
/// parameters. If an option is empty (`by`: not set), the script python/troupe/plot.py uses a default.
struct PlotOptions {
  std::filesystem::path folder;  ///< folder with the results of the sweep
  std::string measure;           ///< name of the measure
  std::string over;              ///< parameter on the x axis; empty: the time
  /// parameters, "A,B": one line in the plot per combination of values; an empty text: one line of all runs
  std::optional<std::string> by;
  std::string bars;           ///< what bars and bands show: "deviation", "interval" or "quartiles"
  std::string title;          ///< title above the plot
  std::filesystem::path out;  ///< picture to write
  bool log_x = false;         ///< whether the x axis is logarithmic
  bool log_y = false;         ///< whether the y axis is logarithmic
};

/// Adds the options of `plot`; parsing fills `options`, which must outlive `command`.
void add_plot_options(CLI::App& command, PlotOptions& options);
/// `troupe plot`: replaces this process by a Python interpreter, which runs the script k_plot_script. The
/// environment variable TROUPE_PYTHON names the interpreter; the default is python3. If Python cannot be
/// started, prints an error and returns k_failed; otherwise does not return.
ExitCode plot(const PlotOptions& options);

}  // namespace troupe::apps
