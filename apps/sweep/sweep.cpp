#include "apps/sweep/sweep.hpp"

#include "apps/csv.hpp"
#include "apps/interrupt.hpp"
#include "apps/messages.hpp"
#include "apps/numbers.hpp"
#include "apps/options.hpp"
#include "apps/outputs.hpp"
#include "apps/ranks/ranks.hpp"
#include "apps/sweep/identity.hpp"
#include "apps/sweep/journal.hpp"
#include "apps/sweep/parallel_runs.hpp"
#include "apps/sweep/table.hpp"
#include "base/diagnostics.hpp"
#include "worldio/files.hpp"
#include "worldio/json/study.hpp"
#include "worldio/partial_file.hpp"
#include "worldio/results/hdf5_file.hpp"
#include "worldio/results/hdf5_superblock.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

using worldio::Study;

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

/// Returns the results in the journals of a folder. Throws OutputError as read_journals() does.
SweepResults saved_results(const Study& study, const SweepIdentity& identity, const fs::path& folder) {
  const std::size_t values = worldio::measure_columns(identity.measures, study.statistics).size();
  return read_journals(folder, identity.text, {.runs = study.run_count(), .values = values}, identity.facts);
}

/// Returns the indices of the runs of this part (--part) that are not finished yet, or whose rows for
/// series.csv are missing.
std::vector<std::size_t> runs_to_make(const Study& study, const SweepOptions& options,
                                      const SweepIdentity& identity) {
  const auto done = saved_results(study, identity, options.folder).outcomes;
  std::vector<std::size_t> runs;
  for (std::size_t r = options.part - 1; r < study.run_count(); r += options.parts)
    if (const auto found = done.find(r);
        found == done.end() || (study.series && !series_rows(options.folder, found->second)))
      runs.push_back(r);
  return runs;
}

/// Returns the runs of this rank. list: the indices of all runs to make, of which rank r makes those at the
/// positions r, r + number of ranks, ...
std::vector<std::size_t> dealt(const std::vector<std::size_t>& list, const RankDeal& deal) {
  std::vector<std::size_t> own;
  for (std::size_t i = deal.rank(); i < list.size(); i += deal.ranks()) own.push_back(list[i]);
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
void forget_old_errors(SweepResults& results, const std::vector<std::size_t>& list,
                       const std::map<std::size_t, std::string>& failed) {
  for (const std::size_t run : list)
    if (!failed.contains(run)) results.failed.erase(run);
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

/// Removes the file series.csv of an earlier sweep, if there is one: its runs are not those of the new
/// tables.
void remove_old_series(const fs::path& folder) {
  const fs::path file = folder / "series.csv";
  std::string start(k_series_mark.size(), '\0');
  std::ifstream(file, std::ios::binary).read(start.data(), static_cast<std::streamsize>(start.size()));
  std::error_code error;
  if (start == k_series_mark && !fs::remove(file, error)) refuse_output(file, error.message());
}

/// Writes the tables of a study whose runs are all done. Throws OutputError if a file cannot be written.
void write_tables(const SweepTable& table, const std::vector<std::string>& measures, const fs::path& folder) {
  if (!table.study.series) remove_old_series(folder);
  write_csv(table, csv_file(folder));
  if (table.study.series) write_series(table, measures, folder);
  if (worldio::has_hdf5()) write_hdf5(table, hdf5_file(folder));
}

/// Prints the errors of failed runs on standard error. An error that several runs have is printed once.
void print_errors(const std::map<std::size_t, std::string>& failed) {
  std::map<std::string_view, std::vector<std::size_t>> runs;
  for (const auto& [run, error] : failed) runs[error].push_back(run);
  for (const auto& [run, error] : failed)
    if (const std::vector<std::size_t>& same = runs[error]; same.front() == run)
      print_message(
          fmt::format("run{} {}: {}\n", same.size() == 1 ? "" : "s", worldio::runs_text(same), error));
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
  Study study = worldio::load_study(options.study, registry_with(options.sources), diagnostics);
  diagnostics.throw_if_errors();
  return study;
}

/// Checks that the tables replace no file that troupe sweep did not write. Throws OutputError.
void check_replaced_tables(const fs::path& folder, bool has_series) {
  constexpr std::string_view k_name = "a table of results (troupe sweep)";
  constexpr std::string_view k_choose = "folder with -o";
  const ReplacedType results{.name = k_name, .mark = k_results_mark, .choose = k_choose};
  check_replaced(csv_file(folder), results);
  if (const std::optional<std::string> text = worldio::read_file(csv_file(folder));
      text && text->size() >= k_results_mark.size() && !is_start_of_results(*text))
    refuse_other_type(csv_file(folder), results);
  if (has_series)
    check_replaced(folder / "series.csv", {.name = k_name, .mark = k_series_mark, .choose = k_choose});
  const fs::path file = hdf5_file(folder);
  const ReplacedType type{.name = k_name, .mark = worldio::k_hdf5_signature, .choose = k_choose};
  std::error_code ignored;
  if (!worldio::has_hdf5() || !fs::is_regular_file(file, ignored)) return;
  check_replaced(file, type);
  if (fs::file_size(file, ignored) < type.mark.size()) return;
  try {
    if (is_hdf5_table(worldio::Hdf5File::open(file))) return;
  } catch (const worldio::Hdf5Error& error) {  // for example, another program has opened the file for writing
    throw OutputError(error.what());
  }
  refuse_other_type(file, type);
}

/// Creates the folder for the results. Throws OutputError if the results could not be written there.
void prepare_folder(const SweepOptions& options, bool has_series) {
  check_folder(options.folder);
  const fs::path series = options.folder / "series";
  if (fs::exists(options.folder)) {
    if (has_series) check_folder(series);
    check_outputs({}, {csv_file(options.folder), hdf5_file(options.folder), options.folder / "series.csv"});
    check_replaced_tables(options.folder, has_series);
  }
  stop_on_signals(options.quiet
                      ? ""
                      : "troupe sweep: stopping; results of finished runs are kept, unfinished runs "
                        "are dropped");
  const fs::path& made = has_series ? series : options.folder;
  std::error_code error;
  fs::create_directories(made, error);
  if (error) refuse_output(made, error.message());
  worldio::sync_folder_of(options.folder);
}

/// Prints how the sweep ended, and writes the tables if all runs of the study are done.
///
/// list: the indices of the runs that this call had to make
/// ranks: number of ranks that made them. Several ranks make all missing runs of the study; otherwise other
/// processes may make those of the other parts (--part)
ExitCode finish(const Study& study, const SweepIdentity& identity, const SweepOptions& options,
                const std::vector<std::size_t>& list, const Ended& ended, unsigned ranks) {
  print_errors(ended.failed);
  SweepTable table{.study = study,
                   .measures = worldio::measure_columns(identity.measures, study.statistics),
                   .world_seed = identity.world_seed,
                   .results = saved_results(study, identity, options.folder),
                   .facts = identity.facts};
  forget_old_errors(table.results, list, ended.failed);
  const bool is_complete = missing_runs(table, 0, 1) == 0;
  if (is_complete) write_tables(table, identity.measures, options.folder);
  if (!options.quiet) print_result(table, is_complete, options.folder);
  if (stop_requested() || (ended.was_stopped && !is_complete)) return k_stopped;
  const std::size_t lost =
      ranks > 1 ? missing_runs(table, 0, 1) : missing_runs(table, options.part - 1, options.parts);
  if (lost > 0)
    throw OutputError(fmt::format(
        "{}: error: the results of {} are missing, so there is no table: {}another program has removed or "
        "replaced files in this folder; repeat the command",
        options.folder.string(), counted(lost, "finished run"),
        ranks > 1 ? "either this folder is not on a file system that all processes share, or " : ""));
  return ended.failed.empty() ? k_finished : k_failed;
}

/// Makes the runs that `deal` gives to this rank. Rank 0 also determines which runs are missing, and writes
/// the tables when all ranks have finished.
ExitCode sweep_on_rank(SweepOptions options, RankDeal& deal) {
  std::vector<std::size_t> list;   // the indices of all runs to make
  std::string identity_of_rank_0;  // SweepIdentity::text; on the other ranks
  if (deal.rank() > 0) {
    const std::optional<partition::Message> shared = deal.shared();  // first, so that rank 0 reports errors
    if (!shared) return k_finished;
    partition::MessageReader reader(*shared);
    identity_of_rank_0 = reader.get_text();
    list = reader.get_all<std::size_t>();
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
  const SweepIdentity identity = identify(study, options, deal.rank() == 0, diagnostics);
  if (deal.rank() > 0 && identity.text != identity_of_rank_0)
    throw InputError(fmt::format(
        "{}: error: this study, its world, or an image, plug-in or script of it differs from that "
        "of rank 0: give all processes the same files",
        options.study.string()));
  options.quiet = options.quiet || deal.rank() > 0;
  prepare_folder(options, study.series);
  if (deal.rank() == 0) {
    list = runs_to_make(study, options, identity);
    partition::MessageWriter writer;
    writer.put_text(identity.text);
    writer.put_all(std::span<const std::size_t>(list));
    deal.share(writer.take());
  }
  if (deal.ranks() > 1) {
    options.part = deal.rank() + 1;
    options.parts = deal.ranks();
  }
  SweepJournal journal(journal_file(options.folder, options.part, options.parts), identity.text,
                       identity.facts);
  Ended here{.failed = make_runs(study, dealt(list, deal), identity.measures, options, journal, deal)};
  here.was_stopped = stop_requested();
  const Ended ended = gathered(here, deal);
  if (deal.rank() > 0) return k_finished;
  try {
    return finish(study, identity, options, list, ended, deal.ranks());
  } catch (const OutputError& error) {  // thrown further, it would say that nothing was written
    print_line(error.what());
    return k_failed;
  }
}

}  // namespace

ExitCode sweep(const SweepOptions& options) {
  return on_each_rank(options.runs_at_once, options.rank_limit_s, [&](RankDeal& deal) {
    try {
      return sweep_on_rank(options, deal);
    } catch (const InputError& error) {
      // An error of this rank alone, for example a plug-in that only its computer lacks: the others wait.
      if (deal.ranks() > 1 && deal.has_shared()) throw std::runtime_error(error.what());
      throw;
    } catch (const OutputError& error) {
      if (deal.ranks() > 1 && deal.has_shared()) throw;  // an error of this rank alone
      print_line(error.what());
      return k_bad_input;
    }
  });
}

}  // namespace troupe::apps
