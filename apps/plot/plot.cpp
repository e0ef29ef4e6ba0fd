#include "apps/plot/plot.hpp"

#include "apps/messages.hpp"
#include "apps/options.hpp"
#include "apps/plot/plot_script.hpp"
#include "apps/scripts.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

namespace troupe::apps {
namespace {

constexpr const char* k_plot_footer = R"(
Plots a measure from the results of troupe sweep. DIR is the folder of the results (-o of troupe sweep).

Without --over, the x axis is the time, and the study file must have "series": true. At each time, a line shows the mean
over all runs that have a value at this time; the band around the line shows one standard deviation of these runs above
and below the mean. With --over, the x axis is a parameter of the study, and each point shows a result of table.csv: the
mean over the runs with this value of the parameter, with a bar of one standard deviation. Without --by there is one
line per combination of values of the parameters that vary between runs (with --over: between runs with the same value
of that parameter); with --by '' there is one line of all runs.

With --bars interval, bars and bands are 95 % confidence intervals of the mean (Student's t distribution). With
--bars quartiles, points and lines are medians, and bars and bands extend from the first to the third quartile.

The measure stopped_by is the fraction of the runs that a condition of stop_when ended, with its 95 % confidence
interval (Wilson); stopped_by:CONDITION is the fraction that this condition ended. Over time, it is the fraction that
ended so up to each time, and needs no "series".

Logarithmic axes (--log-x, --log-y) have only the points above 0. A warning counts the others, except those at 0 s. A
band or bar that reaches down to 0 or below ends at the edge of the plot.

Needs Python with matplotlib: the interpreter in TROUPE_PYTHON, else the one for which the Python package was built,
else the first python3 on PATH.

Exit codes: 0 plotted; 1 failed, or python3 or matplotlib is missing; 2 bad input or usage.

Examples:
  troupe sweep apps/examples/study/coverage.json -o results
  troupe plot results --measure coverage --by robots -o coverage.pdf
  troupe plot results --measure coverage --over robots --bars interval --log-x)";

void add_text(CLI::App& command, const char* name, const char* value, const char* help, std::string& to) {
  add_value(command, name, value, help, [name, &to](const std::string& text) {
    if (text.empty()) refuse(name, text, "a name");
    to = text;
  });
}

}  // namespace

void add_plot_options(CLI::App& command, PlotOptions& options) {
  command.footer(k_plot_footer);
  add_argument(command, "DIR", "Folder with the results of troupe sweep", options.folder);
  add_text(command, "--measure", "NAME", "Measure to plot (default: the first)", options.measure);
  add_text(command, "--over", "NAME", "Parameter on the x axis (default: the time)", options.over);
  add_value(command, "--by", "NAME,...",
            "Parameters: one line per combination of their values; a name that contains a comma is in double "
            "quotes, as in CSV; '': one line of all runs (default: those that vary)",
            [&options](const std::string& text) { options.by = text; });
  add_text(command, "--bars", "deviation|interval|quartiles",
           "What bars and bands show: one standard deviation, 95 % confidence interval, quartiles (default: "
           "deviation)",
           options.bars);
  add_text(command, "--title", "TEXT", "Title above the plot", options.title);
  add_switch(command, "--log-x", options.log_x, "Draw the x axis logarithmically");
  add_switch(command, "--log-y", options.log_y, "Draw the y axis logarithmically");
  add_value(command, "-o,--out", "FILE",
            "Output, a .png, .svg or .pdf (default: DIR/MEASURE.png, or DIR/MEASURE-over-NAME.png)",
            [&options](const std::string& text) { options.out = file_name("--out", text); });
}

ExitCode plot(const PlotOptions& options) {
  const std::string python = python_interpreter();
  // With "=", a value that begins with a minus is not parsed as an option.
  std::vector<std::string> words = {python, "-c", std::string(k_plot_script)};
  const auto add = [&words](const char* name, const std::string& value) {
    if (!value.empty()) words.push_back(fmt::format("{}={}", name, value));
  };
  add("--measure", options.measure);
  add("--over", options.over);
  if (options.by) words.push_back(fmt::format("--by={}", *options.by));
  add("--bars", options.bars);
  add("--title", options.title);
  add("--out", options.out.string());
  if (options.log_x) words.emplace_back("--log-x");
  if (options.log_y) words.emplace_back("--log-y");
  words.insert(words.end(), {"--", options.folder.string()});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::fflush(nullptr);
  execvp(python.c_str(), arguments.data());
  print_message(fmt::format(
      "troupe plot: error: {} cannot be started: {} (Debian, Ubuntu: apt install python3-matplotlib; the "
      "environment variable TROUPE_PYTHON can name another Python interpreter)\n",
      python, std::strerror(errno)));
  return k_failed;
}

}  // namespace troupe::apps
