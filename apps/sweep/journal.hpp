#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::apps {

/// The result of one run of a study (many runs of a world with different parameters and seeds).
struct SweepOutcome {
  std::size_t run = 0;      ///< index of the run in the study
  std::uint64_t seed = 0;   ///< seed of the run
  std::uint64_t ticks = 0;  ///< number of ticks (simulation steps) of the run
  double time_s = 0;        ///< simulated time at the end, s
  std::string stopped_by;   ///< the condition of the world's `stop_when` that ended the run; empty: none
  /// The results of the run. A measure is a number that is computed from the state at intervals; each result
  /// is a statistic of a measure, such as its mean over the run. The results have the order of the names that
  /// worldio::measure_columns() returns for the study. NaN: no value.
  std::vector<double> values;
  std::string state_hash;  ///< hash of the last state, as hexadecimal digits
};

/// The results of runs of a study that are known so far.
struct SweepResults {
  std::map<std::size_t, SweepOutcome> outcomes;  ///< results of finished runs, by index of the run
  std::map<std::size_t, std::string> failed;     ///< errors of failed runs, which have no outcome
};

/// A file (journal) with the results of the runs of one process of `troupe sweep`, one line of JSON per
/// finished or failed run. Each line is on the disk before the thread that made the run starts another run,
/// so that a killed sweep loses only its unfinished runs.
class SweepJournal {
 public:
  /// Opens or creates a journal, and removes an incomplete last line. study: a text that identifies the
  /// study, its world and the version of the program; a new journal stores it. Throws OutputError if an
  /// existing journal stores another text, if the file cannot be written, or if another process writes the
  /// journal.
  SweepJournal(const std::filesystem::path& file, std::string_view study);
  ~SweepJournal();
  SweepJournal(const SweepJournal&) = delete;
  SweepJournal& operator=(const SweepJournal&) = delete;

  /// Appends a finished run. When add() returns, the run is on the disk. Throws std::runtime_error if writing
  /// fails.
  void add(const SweepOutcome& outcome);
  /// Appends the error of a failed run, like add().
  void add_failure(std::size_t run, const std::string& error);

 private:
  void append(std::size_t run, std::string line);

  std::filesystem::path file_;
  int descriptor_ = -1;
};

/// Returns the results in all journals of a folder, which must exist. If a run failed and a later call of
/// `troupe sweep` finished it, only its outcome is returned, not its error. An incomplete last line of a
/// journal is ignored. study: the text that identifies the study, as for SweepJournal. Throws OutputError if
/// a journal stores another text or has a damaged line.
SweepResults read_journals(const std::filesystem::path& folder, std::string_view study);

/// Returns the path of the journal that the process for part `part` of `parts` writes (--part). Parts are
/// counted from 1.
std::filesystem::path journal_file(const std::filesystem::path& folder, std::size_t part, std::size_t parts);

}  // namespace troupe::apps
