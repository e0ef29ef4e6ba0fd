#pragma once

#include "apps/exit_code.hpp"

#include <filesystem>
#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

/// Options of `troupe plot`. Options that are empty have the defaults of python/troupe/plot.py.
struct PlotOptions {
  std::filesystem::path folder;
  std::string measure;
  std::string by;
  std::string title;
  std::filesystem::path out;
};

/// Adds the options of `plot`; parsing fills `options`, which must outlive `command`.
void add_plot_options(CLI::App& command, PlotOptions& options);
/// `troupe plot`: plots a measure of a sweep. Replaces the process by python3, which runs the embedded
/// script. Returns only if python3 cannot be started.
ExitCode plot(const PlotOptions& options);

}  // namespace troupe::apps
