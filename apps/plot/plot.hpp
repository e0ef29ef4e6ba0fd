#pragma once

#include "apps/exit_code.hpp"

#include <filesystem>
#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

/// What the command line of `troupe plot` asks for. Empty: as python/troupe/plot.py chooses.
struct PlotOptions {
  std::filesystem::path folder;
  std::string measure;
  std::string by;
  std::string title;
  std::filesystem::path out;
};

/// Adds the options of `plot`; parsing fills `options`, which must outlive `command`.
void add_plot_options(CLI::App& command, PlotOptions& options);
/// Draws a measure of a sweep: becomes python3, with the script that the program holds. Returns only where
/// there is no python3.
ExitCode plot(const PlotOptions& options);

}  // namespace troupe::apps
