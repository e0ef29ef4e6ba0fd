#include "apps/run/run.hpp"

#include "apps/interrupt.hpp"
#include "apps/messages.hpp"
#include "apps/outputs.hpp"
#include "apps/progress.hpp"
#include "apps/run/world_run.hpp"
#include "base/diagnostics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <filesystem>
#include <functional>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;
using Runs = std::vector<std::unique_ptr<WorldRun>>;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Returns one set of options per world, in which {world} in the names of outputs is replaced by the name of
/// the world. Throws InputError if several worlds would write the same file.
std::vector<RunOptions> one_for_each_world(const RunOptions& options) {
  std::vector<RunOptions> each;
  for (const fs::path& world : options.worlds) {
    RunOptions& own = each.emplace_back(options);
    own.world = world;
    for (fs::path* output : own.outputs.names(own)) {
      if (output->empty()) continue;
      const std::string name = with_world(output->string(), world);
      if (options.worlds.size() > 1 && name == output->string())
        throw InputError(
            fmt::format("troupe run: error: several worlds need different outputs: write {} in the name, as "
                        "in {}-{}; the name of the world replaces {}",
                        k_world_mark, k_world_mark, output->filename().string(), k_world_mark));
      *output = name;
    }
  }
  return each;
}

/// Calls check_outputs() for the inputs and outputs of all worlds. Called before the worlds are loaded, and
/// again after they are loaded, because a world file may name a recording. read: for the second call, the
/// files that the worlds were read from.
void check_files(const std::vector<RunOptions>& each, const std::vector<Input>& read = {}) {
  std::vector<Input> inputs;
  std::vector<fs::path> outputs;
  for (const RunOptions& options : each) {
    inputs.push_back({options.world, options.is_checkpoint ? "the checkpoint" : "the world"});
    if (!options.session.empty()) inputs.push_back({options.session, "the session"});
    add_inputs(options.simulation.scripts, inputs);
    std::ranges::copy(options.outputs.files(options), std::back_inserter(outputs));
  }
  std::ranges::copy(read, std::back_inserter(inputs));
  check_outputs(inputs, outputs);
}

/// Loads all worlds. If worlds have errors, throws one InputError whose text lists the errors of all of them.
Runs load(const std::vector<RunOptions>& each) {
  Runs runs;
  std::string wrong;
  for (const RunOptions& options : each) {
    try {
      runs.push_back(std::make_unique<WorldRun>(options));
    } catch (const InputError& error) {
      wrong += (wrong.empty() ? "" : "\n") + std::string(error.what());
    }
  }
  if (!wrong.empty()) throw InputError(wrong);
  return runs;
}

/// Returns the world whose next tick ends first in simulated time; tick lengths may differ between worlds.
/// Null if all worlds have reached their ends.
WorldRun* next_of(const Runs& runs) {
  WorldRun* next = nullptr;
  for (const auto& run : runs)
    if (!run->is_done() && (!next || run->next_s() < next->next_s())) next = run.get();
  return next;
}

/// Steps all worlds to their ends, or until `is_over` returns true.
void step_to_end(const Runs& runs, const std::function<bool()>& is_over, bool show_progress) {
  const WorldRun& last = **std::ranges::max_element(runs, {}, [](const auto& run) {
    return run->report().end_s;
  });  // the progress bar shows the world with the latest end
  for (const auto& run : runs) run->begin();
  {
    Progress progress(last.simulation().time_s(), last.report().end_s, show_progress);
    for (WorldRun* run = next_of(runs); run && !is_over(); run = next_of(runs)) {
      run->step();
      if (run == &last) progress.update(last.simulation().time_s());
    }
  }
  for (const auto& run : runs) run->finish();
}

/// Throws InputError if options are given that cannot be combined.
void check_combinations(const RunOptions& options) {
  if (options.view && options.worlds.size() > 1)
    throw InputError(fmt::format(
        "--view: error: --view shows the run of one world, but {} worlds are given: give only one",
        options.worlds.size()));
  if (options.view && !options.session.empty())
    throw InputError("--view: error: --view cannot be combined with --session: omit --view");
  if (options.view && options.simulation.processes)
    throw InputError(
        "--view: error: --view shows a run of one process, but a launcher such as mpirun started several: "
        "start the program without the launcher; --ranks N computes N ranks in one process");
  if (options.dry_run && options.view)
    throw InputError("--dry-run: error: --dry-run cannot be combined with --view: omit one of them");
  if (options.dry_run && options.simulation.processes)
    throw InputError(
        "--dry-run: error: --dry-run needs only one process, but a launcher such as mpirun started several: "
        "start the program without the launcher, and give the number of ranks with --ranks");
  if (!options.balances_ranks && options.simulation.processes)
    throw InputError(
        "--rank-balance: error: --rank-balance off is for ranks in one process, but a launcher such as "
        "mpirun started several: omit --rank-balance");
}

/// Loads the worlds, and tries whether the outputs of their runs can be written. Throws InputError or
/// OutputError before anything is written.
Runs rehearsed_runs(const RunOptions& options) {
  std::vector<RunOptions> each = one_for_each_world(options);
  check_files(each);
  Runs runs = load(each);
  stop_on_signals(options.quiet           ? ""
                  : options.is_checkpoint ? "troupe resume: stopping after the current tick"
                                          : "troupe run: stopping after the current tick");
  std::vector<Input> read;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    each[i] = runs[i]->take_names_from_world();
    add_inputs(runs[i]->simulation(), read);
  }
  check_files(each, read);
  for (const auto& run : runs) run->rehearse();
  return runs;
}

/// Calls step_to_end(). If a run fails, saves the checkpoints of all runs that ask for one, and throws the
/// error.
void step_or_save(const Runs& runs, const std::function<bool()>& is_over, bool is_quiet) {
  const bool tells_time = std::ranges::any_of(runs, [](const auto& run) { return run->tells_time(); });
  try {
    step_to_end(runs, is_over, !is_quiet && !tells_time);
  } catch (...) {
    for (const auto& run : runs) run->save_at_least();
    throw;
  }
}

/// Prints the summaries and then draws the last pictures. If a summary cannot be printed, for example on a
/// full disk, draws the pictures before it throws the error.
void summarise(const Runs& runs) {
  std::exception_ptr lost;
  try {
    for (const auto& run : runs) run->print_summary(runs.size() > 1);
  } catch (const std::runtime_error&) {
    lost = std::current_exception();
  }
  for (const auto& run : runs) run->after_summary();
  if (lost) std::rethrow_exception(lost);
}

}  // namespace

ExitCode run(const RunOptions& options) try {
  const auto start = Clock::now();
  check_combinations(options);
  count_save_requests();
  const Runs runs = rehearsed_runs(options);
  const bool prints_options = !options.quiet && !options.json;
  if (options.dry_run) {
    for (const auto& run : runs) {
      if (prints_options) run->print_options();
      run->print_dry_run();
    }
    return k_finished;
  }
  const auto is_over = [&] {
    if (std::ranges::any_of(runs, [](const auto& run) { return run->is_stopped_elsewhere(); }))
      request_stop();
    return stop_requested() || (options.wall_limit_s && seconds_since(start) >= *options.wall_limit_s);
  };
  // The exit code k_bad_input would say that nothing was written.
  const auto failed = [](const std::runtime_error& error) {
    print_line(error.what());
    return k_failed;
  };
  try {
    for (const auto& run : runs) run->open_outputs(is_over);
    if (options.view) runs.front()->open_view(is_over);
    if (prints_options)
      for (const auto& run : runs) run->print_options();
    step_or_save(runs, is_over, options.quiet);
  } catch (const InputError& error) {  // for example because an act of the session is impossible
    return failed(error);
  } catch (const OutputError& error) {
    return failed(error);
  }
  summarise(runs);
  const bool stopped = std::ranges::any_of(runs, [](const auto& run) { return run->report().stopped; });
  return stopped ? k_stopped : k_finished;
} catch (const InputError& error) {
  print_line(error.what());
  return k_bad_input;
} catch (const OutputError& error) {
  print_line(error.what());
  return k_bad_input;
}

}  // namespace troupe::apps
