#include "apps/commands.hpp"

#include "apps/check/check.hpp"
#include "apps/check/check_options.hpp"
#include "apps/completion.hpp"
#include "apps/convert.hpp"
#include "apps/describe.hpp"
#include "apps/diff/diff.hpp"
#include "apps/info/info.hpp"
#include "apps/lint.hpp"
#include "apps/manual.hpp"
#include "apps/pictures/render.hpp"
#include "apps/plot/plot.hpp"
#include "apps/repair.hpp"
#include "apps/replay.hpp"
#include "apps/run/run.hpp"
#include "apps/run/run_options.hpp"
#include "apps/sweep/sweep.hpp"
#include "apps/view/view_command.hpp"
#include "troupe/registry.hpp"

#include <memory>

namespace troupe::apps {
namespace {

template <class Options>
ProgramCommand row(const char* name, const char* help, void (*add_options)(CLI::App&, Options&),
                   ExitCode (*run)(const Options&)) {
  const auto options = std::make_shared<Options>();
  return {.name = name,
          .help = help,
          .add_options = [options, add_options](CLI::App& command) { add_options(command, *options); },
          .run = [options, run] { return run(*options); },
          .options = options};
}

ExitCode check_shipped(const CheckOptions& options) { return check(options, make_registry()); }

}  // namespace

std::vector<ProgramCommand> program_commands() {
  return {
      row("run", "Run a world and tell how it went", add_run_options, run),
      row("resume", "Go on with a run from its checkpoint", add_resume_options, run),
      row("view", "Watch and steer a world in a browser", add_view_options, view_world),
      row("sweep", "Make all runs of a study, and one table of them", add_sweep_options, sweep),
      row("plot", "Draw a measure of a sweep over time", add_plot_options, plot),
      row("check", "Prove that a world gives the same bits on any threads and tiles", add_check_options,
          check_shipped),
      row("diff", "Find the first tick at which two hash logs or recordings differ", add_diff_options, diff),
      row("repair", "Make a recording that was cut off readable for plain tools", add_repair_options, repair),
      row("convert", "Write a world in another format: .world or .json", add_convert_options, convert),
      row("render", "Draw a world, a checkpoint or a recording", add_render_options, render_pictures),
      row("replay", "Make a page that plays a recording in a browser", add_replay_options, replay),
      row("lint", "Look a world over for what is surely not meant", add_lint_options, lint_world),
      row("info", "Tell what a file is and what it holds", add_info_options, info),
      row("describe", "List what worlds are made of, or the parameters of one kind", add_describe_options,
          describe),
      row("completion", "Print the script with which a shell completes troupe's words",
          add_completion_options, print_completion),
      row("manual", "Print the manual page, for man", add_manual_options, print_manual),
  };
}

}  // namespace troupe::apps
