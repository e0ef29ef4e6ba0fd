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
#include "apps/ranks/ranks.hpp"
#include "apps/repair.hpp"
#include "apps/replay.hpp"
#include "apps/run/run.hpp"
#include "apps/run/run_options.hpp"
#include "apps/sweep/sweep.hpp"
#include "apps/view_command.hpp"
#include "troupe/registry.hpp"

#include <iterator>
#include <memory>
#include <type_traits>

namespace troupe::apps {
namespace {

/// A command with options of the type `Options`.
template <class Options>
class CommandWith : public ProgramCommand {
 public:
  using AddOptions = void (*)(CLI::App&, Options&);
  using Run = ExitCode (*)(const Options&);
  CommandWith(const char* name, const char* help, AddOptions add, Run start, bool runs_on_ranks)
      : ProgramCommand(name, help, runs_on_ranks), add_options_(add), run_(start) {}
  void add_options(CLI::App& command) override { add_options_(command, options_); }
  ExitCode run() const override { return run_(options_); }
  std::any options() override { return &options_; }

 protected:
  AddOptions add_options_;
  Run run_;
  Options options_{};
};

/// A command that simulates its worlds on all processes of a launcher such as mpirun.
template <class Options>
class CommandOnRanks : public CommandWith<Options> {
 public:
  using CommandWith<Options>::CommandWith;
  ExitCode run() const override {
    constexpr RankSignals k_signals =
        std::is_same_v<Options, RunOptions> ? RankSignals::stop : RankSignals::kill;
    return on_ranks(this->options_, k_signals, [this](const SimulationOptions& simulation) {
      Options own = this->options_;
      own.simulation = simulation;
      return this->run_(own);
    });
  }
};

/// Returns a command that runs in one process.
template <class Options>
std::unique_ptr<ProgramCommand> row(const char* name, const char* help,
                                    void (*add_options)(CLI::App&, Options&),
                                    ExitCode (*run)(const Options&)) {
  return std::make_unique<CommandWith<Options>>(name, help, add_options, run, false);
}

/// Returns a command whose run() itself connects the processes of a launcher such as mpirun.
template <class Options>
std::unique_ptr<ProgramCommand> row_of_any(const char* name, const char* help,
                                           void (*add_options)(CLI::App&, Options&),
                                           ExitCode (*run)(const Options&)) {
  return std::make_unique<CommandWith<Options>>(name, help, add_options, run, true);
}

/// Returns a CommandOnRanks.
template <class Options>
std::unique_ptr<ProgramCommand> row_of_ranks(const char* name, const char* help,
                                             void (*add_options)(CLI::App&, Options&),
                                             ExitCode (*run)(const Options&)) {
  return std::make_unique<CommandOnRanks<Options>>(name, help, add_options, run, true);
}

ExitCode check_shipped(const CheckOptions& options) { return check(options, make_registry()); }

}  // namespace

std::vector<std::unique_ptr<ProgramCommand>> program_commands() {
  std::unique_ptr<ProgramCommand> commands[] = {
      row_of_ranks("run", "Run a world and print a summary", add_run_options, run),
      row_of_ranks("resume", "Continue a run from a checkpoint", add_resume_options, run),
      row("view", "Watch and steer a world in a browser", add_view_options, view_world),
      row_of_any("sweep", "Run a world many times with varied parameters and seeds, and tabulate the results",
                 add_sweep_options, sweep),
      row("plot", "Plot a measure of a sweep over time or over a parameter", add_plot_options, plot),
      row_of_ranks("check",
                   "Check that results do not depend on the number of threads or ranks or the tile size",
                   add_check_options, check_shipped),
      row("diff", "Compare two hash logs, recordings or tables of sweeps", add_diff_options, diff),
      row("repair", "Make the recording of a killed run readable by standard HDF5 tools", add_repair_options,
          repair),
      row("convert", "Write a world in another format: .world or .json", add_convert_options, convert),
      row("render", "Draw a world, a checkpoint or a recording", add_render_options, render_pictures),
      row("replay", "Write a page that plays a recording in a browser", add_replay_options, replay),
      row("lint", "Report likely mistakes in a world", add_lint_options, lint_world),
      row("info", "Print the type and a summary of a file", add_info_options, info),
      row("describe", "List all kinds, or describe a kind or a key of JSON worlds", add_describe_options,
          describe),
      row("completion", "Print the completion script for bash, zsh or fish", add_completion_options,
          print_completion),
      row("manual", "Print the manual page troupe(1)", add_manual_options, print_manual),
  };
  return {std::make_move_iterator(std::begin(commands)), std::make_move_iterator(std::end(commands))};
}

}  // namespace troupe::apps
