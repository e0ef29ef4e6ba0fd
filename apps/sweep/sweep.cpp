#include "apps/sweep/sweep.hpp"

#include "apps/csv.hpp"
#include "apps/interrupt.hpp"
#include "apps/options.hpp"
#include "apps/outputs.hpp"
#include "apps/ranks/ranks.hpp"
#include "apps/scripts.hpp"
#include "apps/sweep/journal.hpp"
#include "apps/sweep/table.hpp"
#include "base/diagnostics.hpp"
#include "base/hash.hpp"
#include "base/number_text.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/world/world.hpp"
#include "troupe/measures.hpp"
#include "troupe/plugins.hpp"
#include "troupe/registry.hpp"
#include "worldio/files.hpp"
#include "worldio/json/spec_json.hpp"
#include "worldio/json/study.hpp"
#include "worldio/results/hdf5_file.hpp"
#include "worldio/whole_file.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <exception>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <tuple>
#include <utility>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

using worldio::Statistic;
using worldio::Study;

constexpr const char* k_sweep_footer = R"(
A study is a JSON file that names a world, the parameters that vary between runs (a grid or random samples), seeds and
measures (docs/sweeps.md). Runs are made in parallel, each on one thread. When a run finishes, its result is saved in
DIR. To continue a sweep that was stopped or killed, give the same command again. When all runs are finished, DIR
contains the table with one row per run (table.csv and table.h5). If the study has "series": true, DIR also contains the
measures over time (series.csv), which troupe plot draws. The tables depend neither on the number of parallel runs nor
on interruptions.

With --part, several machines share a study, as in a SLURM array of eight jobs:
  sbatch --array=1-8 --wrap 'troupe sweep study.json -o results --part $SLURM_ARRAY_TASK_ID/8'
The process that finishes last writes the tables. Under mpirun or srun, all processes share the runs (docs/cluster.md):
  mpirun -n 8 troupe sweep study.json -o results

Exit codes: 0 finished (with --part: this part); 1 runs failed, see the messages and the table's column `error`; 2 bad
study or usage; 3 stopped by Ctrl-C or SIGTERM.

Examples:
  troupe sweep apps/examples/study/coverage.json -o results
  troupe sweep apps/examples/study/coverage.json --list)";

SimulationOptions options_of(const Study& study, const Study::Run& run, const SweepOptions& options) {
  SimulationOptions simulation = with_environment({});
  simulation.plugin_path = plugin_path(options.plugin_path);
  simulation.scripts = options.scripts;
  simulation.threads = 1;
  simulation.seed = run.seed;
  simulation.set = study.settings(run);
  return simulation;
}

/// Computes statistics of each column of measures over the samples of a run. Missing values (NaN) are
/// ignored, except by the statistic `last`.
class Statistics {
 public:
  explicit Statistics(std::size_t columns) : columns_(columns) {}

  void add(const std::vector<double>& values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      Column& column = columns_[i];
      column.last = values[i];
      if (std::isnan(values[i])) continue;
      ++column.count;
      column.sum += values[i];
      column.min = std::min(column.min, values[i]);
      column.max = std::max(column.max, values[i]);
    }
  }

  std::vector<double> values(const std::vector<Statistic>& wanted) const {
    constexpr double k_none = std::numeric_limits<double>::quiet_NaN();
    std::vector<double> values;
    for (const Column& column : columns_)
      for (const Statistic statistic : wanted) switch (statistic) {
          case Statistic::last: values.push_back(column.last); break;
          case Statistic::mean:
            values.push_back(column.count > 0 ? column.sum / static_cast<double>(column.count) : k_none);
            break;
          case Statistic::min: values.push_back(column.count > 0 ? column.min : k_none); break;
          case Statistic::max: values.push_back(column.count > 0 ? column.max : k_none); break;
        }
    return values;
  }

 private:
  struct Column {
    double last = std::numeric_limits<double>::quiet_NaN();
    double sum = 0;
    double min = std::numeric_limits<double>::infinity();
    double max = -std::numeric_limits<double>::infinity();
    std::size_t count = 0;
  };
  std::vector<Column> columns_;
};

/// Returns the end of a run in simulated time, s. Throws InputError if neither the study nor the world has
/// one.
double end_of(const Study& study, const Simulation& simulation) {
  if (study.for_s) return *study.for_s;
  if (const auto quit = simulation.quit_time_s()) return *quit;
  throw InputError(
      fmt::format("{}: error: no end time: give \"for_s\" in the study, or set quit_time_s in the world "
                  "(quit_time in a .world)",
                  study.world.string()));
}

/// The results of a run.
struct Made {
  SweepOutcome outcome;
  std::string series;  ///< the rows of the run in series.csv; empty if the study has no series
};

/// The values of the measures with the names `columns`; NaN for a column that these measures do not have. If
/// the study names no measures, the world of a run may have others than the world that gave the columns.
std::vector<double> values_of(Measures& measures, const std::vector<std::string>& columns) {
  const std::vector<double> own = measures.values();
  std::vector<double> values;
  for (const std::string& column : columns) {
    const auto found = std::ranges::find(measures.columns(), column);
    const bool is_there = found != measures.columns().end();
    values.push_back(is_there ? own[static_cast<std::size_t>(found - measures.columns().begin())]
                              : std::numeric_limits<double>::quiet_NaN());
  }
  return values;
}

/// Makes one run and returns its results; std::nullopt if Ctrl-C or SIGTERM stopped the run. index: index of
/// the run in the study. columns: names of the measures in the tables
std::optional<Made> make(const Study& study, std::size_t index, const std::vector<std::string>& columns,
                         const SweepOptions& options) {
  Simulation simulation(study.world, options_of(study, study.run(index), options));
  Measures measures(simulation, study.measures);
  Statistics statistics(columns.size());
  const std::uint64_t end = engine::ticks_until(end_of(study, simulation), simulation.tick_s());
  const std::uint64_t every = engine::period_ticks(study.measure_every_s, simulation.tick_s());
  std::string series;
  const auto add_sample = [&] {
    const std::vector<double> values = values_of(measures, columns);
    statistics.add(values);
    if (study.series) add_series_row(series, index, simulation.time_s(), values);
  };
  add_sample();
  while (simulation.tick() < end && !simulation.stopped()) {
    if (stop_requested()) return std::nullopt;
    simulation.step();
    measures.see();
    const bool is_last = simulation.tick() == end || simulation.stopped();
    if (simulation.tick() % every == 0 || is_last) add_sample();
  }
  return Made{.outcome = {.run = index,
                          .seed = simulation.world().spec().seed,
                          .ticks = simulation.tick(),
                          .time_s = simulation.time_s(),
                          .stopped_by = simulation.stopped().value_or(""),
                          .values = statistics.values(study.statistics),
                          .state_hash = hex(simulation.state_hash())},
              .series = std::move(series)};
}

/// Returns the world of the first run whose world can be loaded. Of a large study, it tries only some runs,
/// less and less densely, because loading all worlds can take hours. Throws the InputError of run 0 if it
/// finds no such run.
Simulation first_world(const Study& study, const SweepOptions& options) {
  std::exception_ptr first;
  for (std::size_t run = 0; run < study.run_count(); run += 1 + run / 4) try {
      return Simulation(study.world, options_of(study, study.run(run), options));
    } catch (const InputError&) {
      if (!first) first = std::current_exception();
    }
  std::rethrow_exception(first);
}

/// The contents of a loaded world, with its images, plug-ins and scripts, as text. It does not depend on the
/// folders of the files.
std::string contents_of(const Simulation& simulation) {
  auto spec = nlohmann::json::parse(worldio::spec_to_json(simulation.world().spec(), simulation.registry()));
  spec.erase("files");
  std::string text = fmt::format("{}\n{:016x}\n", spec.dump(), simulation.state_hash());
  for (const auto& [option, value] : simulation.effective_options())
    if (option.starts_with("plugin ")) text += fmt::format("{} {}\n", option, value);
  return text;
}

/// Whether a JSON value is or contains the path of a file, relative to the folder of the world, or the name
/// of a kind of a plug-in in one of these folders: "walker" and "walker:fast" are kinds of walker.so.
bool names_file(const nlohmann::json& value, const fs::path& world, const std::vector<fs::path>& plugins) {
  if (value.is_string()) {
    const auto text = value.get<std::string>();
    const std::string library = text.substr(0, text.find(':')) + ".so";
    std::error_code ignored;
    return fs::is_regular_file(world.parent_path() / text, ignored) ||
           std::ranges::any_of(plugins, [&](const fs::path& folder) {
             return fs::is_regular_file(folder / library, ignored);
           });
  }
  return std::ranges::any_of(value, [&](const auto& element) {
    return value.is_structured() && names_file(element, world, plugins);
  });
}

/// A hash of the worlds with each listed value of a parameter that names a file, such as the image of a floor
/// plan or a plug-in: the file is not part of the study, and run 0 may not read it.
std::string hash_of_choices(const Study& study, const SweepOptions& options) {
  const std::vector<fs::path> plugins = plugin_path(options.plugin_path);
  std::string hashes;
  for (std::size_t p = 0; p < study.choices.size(); ++p)
    for (const std::string& value : study.choices[p].values) {
      if (!names_file(nlohmann::json::parse(value), study.world, plugins)) continue;
      Study::Run run = study.run(0);
      run.values[p] = value;
      try {
        hashes += hex(hash_text(contents_of(Simulation(study.world, options_of(study, run, options)))));
      } catch (const InputError&) {
        hashes += value;  // only other runs, or none, can have this value
      }
    }
  return hashes;
}

/// Returns a text that identifies the study, and the names of the columns of its measures. The text is a hash
/// of the study file, the worlds with their images, plug-ins and scripts (--controller), and the version of
/// the program; it does not depend on the folders of the files. Loads the world of a run, so that errors in
/// the worlds of all runs are reported before any run.
std::pair<std::string, std::vector<std::string>> identify(const Study& study, const SweepOptions& options,
                                                          bool shows_warnings) {
  Simulation simulation = first_world(study, options);
  const Measures measures(simulation, study.measures);
  end_of(study, simulation);
  if (shows_warnings)
    for (const std::string& warning : simulation.warnings()) fmt::print(stderr, "{}\n", warning);
  const std::string text =
      fmt::format("{}\n{}{}{}", worldio::read_file(options.study).value_or(""), contents_of(simulation),
                  hash_of_choices(study, options), version_line());
  return {hex(hash_text(text)), {measures.columns().begin(), measures.columns().end()}};
}

/// Returns the errors of a run, one per line. A run sets each parameter of the study as `--set POINTER` does;
/// in errors that name this option, the position of the parameter in the study file replaces the option.
std::string at_parameters(const Study& study, const std::string& errors, const Diagnostics& diagnostics) {
  std::string text;
  std::istringstream lines(errors);
  for (std::string line; std::getline(lines, line);) {
    for (std::size_t p = 0; p < study.parameters.size(); ++p) {
      const std::string mark = fmt::format("--set {}: error: ", study.parameters[p].pointer);
      if (line.starts_with(mark))
        line = diagnostics.text({Severity::error, study.parameters[p].where,
                                 fmt::format("/parameters/{}: {}", p, line.substr(mark.size()))});
    }
    text += (text.empty() ? "" : "\n") + line;
  }
  return text;
}

/// Prints the number of finished runs on standard error, if standard error is a terminal.
class Count {
 public:
  Count(std::size_t done, std::size_t all, bool wanted)
      : done_(done), all_(all), visible_(wanted && isatty(STDERR_FILENO) != 0) {
    show();
  }
  ~Count() {
    if (visible_) std::fputs("\r\x1b[K", stderr);
  }
  Count(const Count&) = delete;
  Count& operator=(const Count&) = delete;
  void add_one() {
    ++done_;
    show();
  }

 private:
  void show() const {
    if (visible_) fmt::print(stderr, "\r\x1b[K{} of {} runs", done_, all_);
  }
  std::size_t done_;
  std::size_t all_;
  bool visible_;
};

/// Writes the samples of a run, `rows`, to the file that series_file() names. Throws std::runtime_error if
/// writing fails.
void keep_series(const fs::path& file, const std::string& rows) {
  try {
    worldio::write_whole(file, {rows});
  } catch (const std::system_error& error) {
    throw std::runtime_error(
        fmt::format("{}: error: writing failed: {}", file.string(), error.code().message()));
  }
}

/// Makes the runs with these indices in parallel. columns: names of the measures in the tables. When a run
/// finishes or fails, writes its result or its error to the journal. Returns the errors of failed runs, by
/// index. Throws the error if the result of a run cannot be written. During the runs, tells the other ranks
/// that this rank is at work.
std::map<std::size_t, std::string> make_all(const Study& study, const std::vector<std::size_t>& runs,
                                            const std::vector<std::string>& columns,
                                            const SweepOptions& options, SweepJournal& journal,
                                            RankDeal& deal) {
  std::map<std::size_t, std::string> failed;
  std::exception_ptr write_error;  // error of writing a result, which ends the sweep
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  Count count(study.run_count() - runs.size(), study.run_count(), !options.quiet);
  const auto work = [&] {
    while (!stop_requested()) {
      const std::size_t i = next++;
      if (i >= runs.size()) return;
      std::optional<Made> made;
      std::optional<std::string> error;
      try {
        made = make(study, runs[i], columns, options);
      } catch (const std::exception& thrown) {
        error = thrown.what();
      } catch (...) {  // a plug-in may throw anything
        error = "unknown exception (not derived from std::exception)";
      }
      const std::lock_guard lock(mutex);
      if (error) failed.emplace(runs[i], *error);
      try {
        if (error) journal.add_failure(runs[i], *error);
        if (!made) continue;
        // The rows are written before the entry in the journal, so that they exist for every run in the
        // journal.
        if (study.series) keep_series(series_file(options.folder, runs[i]), made->series);
        journal.add(made->outcome);
        count.add_one();
      } catch (...) {
        write_error = std::current_exception();
        next = runs.size();
      }
    }
  };
  std::size_t working = std::min<std::size_t>(deal.threads(), runs.size());
  std::condition_variable ended;
  std::vector<std::jthread> workers;
  for (std::size_t w = working; w > 0; --w)
    workers.emplace_back([&] {
      work();
      const std::lock_guard lock(mutex);
      working -= 1;
      ended.notify_one();
    });
  try {
    for (std::unique_lock lock(mutex);
         !ended.wait_for(lock, deal.interval(), [&] { return working == 0; });) {
      lock.unlock();
      deal.tell_that_it_works();
      lock.lock();
    }
  } catch (...) {
    next = runs.size();
    throw;
  }
  workers.clear();  // joins the threads
  if (write_error) std::rethrow_exception(write_error);
  return failed;
}

/// Prints the list of runs as comma-separated values (--list).
void print_runs(const Study& study) {
  fmt::print("run");
  for (const Study::Parameter& parameter : study.parameters) fmt::print(",{}", csv_cell(parameter.name));
  fmt::print(",seed\n");
  for (std::size_t r = 0; r < study.run_count(); ++r) {
    const Study::Run run = study.run(r);
    fmt::print("{}", r);
    for (const std::string& value : run.values) fmt::print(",{}", csv_cell(shown_value(value)));
    fmt::print(",{}\n", run.seed ? fmt::format("{}", *run.seed) : "world's");
  }
}

/// What a sweep knows of the worlds of its study.
struct Identity {
  std::string text;                   // identifies the study in journals
  std::vector<std::string> measures;  // names of the columns of its measures
};

/// Returns the results in the journals of a folder. Throws OutputError as read_journals() does.
SweepResults saved_results(const Study& study, const Identity& identity, const fs::path& folder) {
  const std::size_t values = worldio::measure_columns(identity.measures, study.statistics).size();
  return read_journals(folder, identity.text, {.runs = study.run_count(), .values = values});
}

/// Returns the indices of the runs of this part (--part) that are not finished yet.
std::vector<std::size_t> runs_to_make(const Study& study, const SweepOptions& options,
                                      const Identity& identity) {
  const auto done = saved_results(study, identity, options.folder).outcomes;
  std::vector<std::size_t> runs;
  for (std::size_t r = options.part - 1; r < study.run_count(); r += options.parts)
    if (!done.contains(r) || (study.series && !fs::exists(series_file(options.folder, r)))) runs.push_back(r);
  return runs;
}

/// Returns the runs of this rank. list: the indices of all runs to make, of which rank r makes those at the
/// positions r, r + number of ranks, ...
std::vector<std::size_t> dealt(const partition::Message& list, const RankDeal& deal) {
  partition::MessageReader reader(list);
  std::vector<std::size_t> own;
  for (std::size_t i = 0; !reader.is_done(); ++i)
    if (const auto run = reader.get<std::uint64_t>(); i % deal.ranks() == deal.rank()) own.push_back(run);
  return own;
}

/// How the runs of one rank or of all ranks ended.
struct Ended {
  std::map<std::size_t, std::string> failed;  // errors of the failed runs, by index
  bool was_stopped = false;                   // a signal ended the sweep before its last run
};

/// Sends `here`, which states how the runs of this rank ended, to rank 0. On rank 0, waits until all ranks
/// have finished their runs, and returns how the runs of all ranks ended; on other ranks, returns an empty
/// Ended.
Ended gathered(const Ended& here, const RankDeal& deal) {
  partition::MessageWriter own;
  own.put(std::uint64_t{here.was_stopped});
  for (const auto& [run, error] : here.failed) {
    own.put(std::uint64_t{run});
    own.put_text(error);
  }
  Ended all;
  for (const partition::Message& message : deal.gather(own.take())) {
    partition::MessageReader reader(message);
    if (reader.get<std::uint64_t>() != 0) all.was_stopped = true;
    while (!reader.is_done()) {
      const auto run = reader.get<std::uint64_t>();
      all.failed[run] = reader.get_text();
    }
  }
  return all;
}

/// Removes the errors that earlier calls wrote to journals for runs that this call had to make again, but
/// that it did not make because a signal stopped it. list: the indices of the runs that this call had to
/// make; failed: those of them that failed.
void forget_old_errors(SweepResults& results, const partition::Message& list,
                       const std::map<std::size_t, std::string>& failed) {
  for (partition::MessageReader reader(list); !reader.is_done();)
    if (const auto run = reader.get<std::uint64_t>(); !failed.contains(run)) results.failed.erase(run);
}

/// Returns how many of the runs first, first + step, ... of the study have neither a result nor an error.
std::size_t missing_runs(const SweepTable& table, std::size_t first, std::size_t step) {
  std::size_t missing = 0;
  for (std::size_t r = first; r < table.study.run_count(); r += step)
    if (!table.results.outcomes.contains(r) && !table.results.failed.contains(r)) missing += 1;
  return missing;
}

fs::path csv_file(const fs::path& folder) { return folder / "table.csv"; }
fs::path hdf5_file(const fs::path& folder) { return folder / "table.h5"; }

/// Writes the tables of a study whose runs are all done. Throws OutputError if a file cannot be written.
void write_tables(const SweepTable& table, const std::vector<std::string>& measures, const fs::path& folder) {
  write_csv(table, csv_file(folder));
  if (table.study.series) write_series(table, measures, folder);
  if (worldio::has_hdf5()) write_hdf5(table, hdf5_file(folder));
}

void print_result(const SweepTable& table, bool is_complete, const fs::path& folder) {
  fmt::print("{} of {} runs done", table.results.outcomes.size(), table.study.run_count());
  if (!table.results.failed.empty()) fmt::print(", {} failed", table.results.failed.size());
  if (is_complete)
    fmt::print(": {}{}\n", csv_file(folder).string(),
               table.study.series ? ", " + (folder / "series.csv").string() : std::string());
  else
    fmt::print("; the table is written when all runs are done\n");
}

/// Reads and checks the study. Throws InputError with all errors.
Study checked_study(const SweepOptions& options, Diagnostics& diagnostics) {
  engine::Registry registry = make_registry();
  add_plugins(registry, plugin_path(options.plugin_path), options.scripts);
  Study study = worldio::load_study(options.study, registry, diagnostics);
  diagnostics.throw_if_errors();
  return study;
}

/// Like identify(), but errors name the positions of parameters in the study, and columns of the same name
/// are errors too.
Identity checked_identity(const Study& study, const SweepOptions& options, bool shows_warnings,
                          Diagnostics& diagnostics) {
  Identity identity;
  try {
    std::tie(identity.text, identity.measures) = identify(study, options, shows_warnings);
  } catch (const InputError& error) {
    throw InputError(at_parameters(study, error.what(), diagnostics));
  }
  worldio::check_columns(study, identity.measures, diagnostics);
  diagnostics.throw_if_errors();
  return identity;
}

/// Creates the folder for the results. Throws OutputError if the results could not be written there.
void prepare_folder(const SweepOptions& options, bool has_series) {
  check_folder(options.folder);
  if (fs::exists(options.folder))
    check_outputs({}, {csv_file(options.folder), hdf5_file(options.folder), options.folder / "series.csv"});
  stop_on_signals();
  fs::create_directories(has_series ? options.folder / "series" : options.folder);
}

/// Prints how the sweep ended, and writes the tables if all runs of the study are done.
///
/// list: the indices of the runs that this call had to make
/// all_are_here: whether this call had to make all missing runs of the study; otherwise other processes make
/// those of the other parts (--part)
ExitCode finish(const Study& study, const Identity& identity, const SweepOptions& options,
                const partition::Message& list, const Ended& ended, bool all_are_here) {
  for (const auto& [run, error] : ended.failed) fmt::print(stderr, "run {}: {}\n", run, error);
  SweepTable table{.study = study,
                   .measures = worldio::measure_columns(identity.measures, study.statistics),
                   .results = saved_results(study, identity, options.folder)};
  forget_old_errors(table.results, list, ended.failed);
  const bool is_complete = missing_runs(table, 0, 1) == 0;
  if (is_complete) write_tables(table, identity.measures, options.folder);
  if (!options.quiet) print_result(table, is_complete, options.folder);
  if (stop_requested() || (ended.was_stopped && !is_complete)) return k_stopped;
  const std::size_t lost =
      all_are_here ? missing_runs(table, 0, 1) : missing_runs(table, options.part - 1, options.parts);
  if (lost > 0)
    throw OutputError(fmt::format(
        "{}: error: the results of {} finished run{} are missing, so there is no table: another program "
        "has removed or replaced files in this folder; repeat the command",
        options.folder.string(), lost, lost == 1 ? "" : "s"));
  return ended.failed.empty() ? k_finished : k_failed;
}

ExitCode sweep_checked(SweepOptions options, RankDeal& deal) {
  partition::Message list;  // the indices of all runs to make
  if (deal.rank() > 0) {
    std::optional<partition::Message> shared = deal.shared();  // first, so that rank 0 reports errors
    if (!shared) return k_finished;
    list = *std::move(shared);
  }
  Diagnostics diagnostics;
  const Study study = checked_study(options, diagnostics);
  if (deal.ranks() > 1 && options.parts > 1)
    throw InputError(
        "troupe sweep: error: --part cannot be used under a launcher such as mpirun, where all processes "
        "share the runs: leave out --part");
  if (options.list) {
    print_runs(study);
    return k_finished;
  }
  if (options.folder.empty())
    throw InputError(
        "troupe sweep: error: -o DIR is required: the folder for the results of the runs and the tables");
  const Identity identity = checked_identity(study, options, deal.rank() == 0, diagnostics);
  prepare_folder(options, study.series);
  if (deal.rank() == 0) {
    partition::MessageWriter writer;
    for (const std::size_t run : runs_to_make(study, options, identity)) writer.put(std::uint64_t{run});
    list = writer.take();
    deal.share(list);
  }
  if (deal.ranks() > 1) {
    options.part = deal.rank() + 1;
    options.parts = deal.ranks();
    options.quiet = options.quiet || deal.rank() > 0;
  }
  SweepJournal journal(journal_file(options.folder, options.part, options.parts), identity.text);
  Ended here{.failed = make_all(study, dealt(list, deal), identity.measures, options, journal, deal)};
  here.was_stopped = stop_requested();
  const Ended ended = gathered(here, deal);
  if (deal.rank() > 0) return k_finished;
  try {
    return finish(study, identity, options, list, ended, deal.ranks() > 1);
  } catch (const OutputError& error) {  // thrown further, it would say that nothing was written
    fmt::print(stderr, "{}\n", error.what());
    return k_failed;
  }
}

}  // namespace

void add_sweep_options(CLI::App& command, SweepOptions& options) {
  command.footer(k_sweep_footer);
  command
      .add_option_function<std::string>(
          "STUDY", [&options](const std::string& text) { options.study = text; }, "Study, in JSON")
      ->option_text(" ")
      ->required();
  add_value(command, "-o,--out", "DIR", "Folder for the results of the runs and the tables; may exist",
            [&options](const std::string& text) {
              if (text.empty() || text.starts_with('-')) refuse("--out", text, "the name of a folder");
              options.folder = text;
            });
  add_value(command, "--threads", "N", "Number of parallel runs (default: one per available processor)",
            [&options](const std::string& text) { options.runs_at_once = thread_count(text); });
  add_value(command, "--part", "I/N", "Make only every N-th run, beginning with the I-th (1 to N)",
            [&options](const std::string& text) {
              const auto slash = text.find('/');
              const auto part = number_of<std::size_t>(text.substr(0, slash));
              const auto parts =
                  slash == text.npos ? std::nullopt : number_of<std::size_t>(text.substr(slash + 1));
              if (!part || !parts || *part < 1 || *part > *parts || *parts > worldio::k_most_runs)
                refuse("--part", text,
                       fmt::format("a part I/N, with I from 1 to N and N at most {}, as in --part 2/8",
                                   worldio::k_most_runs));
              options.part = *part;
              options.parts = *parts;
            });
  command.add_flag("--list", options.list, "Print the list of runs without making them")
      ->disable_flag_override();
  command.add_flag("--quiet", options.quiet, "Print only errors")->disable_flag_override();
  add_kind_options(command, options.plugin_path, options.scripts);
  add_simd_option(command);
  add_rank_limit_option(command, options.rank_limit_s);
}

ExitCode sweep(const SweepOptions& options) {
  return on_each_rank(options.runs_at_once, options.rank_limit_s, [&](RankDeal& deal) {
    try {
      return sweep_checked(options, deal);
    } catch (const InputError& error) {
      // An error of this rank alone, for example a plug-in that only its computer lacks: the others wait.
      if (deal.ranks() > 1 && deal.has_shared()) throw std::runtime_error(error.what());
      throw;
    } catch (const OutputError& error) {
      if (deal.ranks() > 1 && deal.has_shared()) throw;  // an error of this rank alone
      fmt::print(stderr, "{}\n", error.what());
      return k_bad_input;
    }
  });
}

}  // namespace troupe::apps
