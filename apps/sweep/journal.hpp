#pragma once

#include "worldio/results/descriptor.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::apps {

/// The result of one run of a study (many runs of a world with different parameters and seeds).
struct SweepOutcome {
  std::size_t run = 0;      ///< index of the run in the study
  std::uint64_t seed = 0;   ///< seed of the run
  std::uint64_t ticks = 0;  ///< number of ticks (time steps) of the run
  double time_s = 0;        ///< simulated time at the end, s
  std::string stopped_by;   ///< the condition of the world's `stop_when` that ended the run; empty: none
  /// The results of the run: statistics of measures. A measure is a number that is computed from the state at
  /// intervals, such as the covered area; a statistic is, for example, the mean of a measure over the run.
  /// worldio::measure_columns() returns the names of the results, in the same order. NaN: no value.
  std::vector<double> values;
  std::string state_hash;  ///< hash of the last state, as hexadecimal digits
};

/// The results of a study that are known so far. A run is in neither map until it has ended.
struct SweepResults {
  std::map<std::size_t, SweepOutcome> outcomes;  ///< results of finished runs, by index of the run
  std::map<std::size_t, std::string> failed;     ///< errors of failed runs, which have no outcome
};

/// What each result of a study must fit.
struct SweepSize {
  std::size_t runs = 0;    ///< number of runs of the study
  std::size_t values = 0;  ///< number of SweepOutcome::values of each run
};

/// What results of a study depend on, as names and values: the version of the program, and hashes of the
/// study file, of the world and of each plug-in. With them a user can tell from which files the results come.
using StudyFacts = std::vector<std::pair<std::string, std::string>>;

/// The bytes with which every journal of a sweep begins.
inline constexpr std::string_view k_journal_mark = R"({"troupe_sweep":)";

/// The journal of one process of `troupe sweep`: a file with the results of its runs, one line of JSON per
/// finished or failed run. A result is on the disk when add() returns, so a killed sweep loses only its
/// unfinished runs.
class SweepJournal {
 public:
  /// Opens or creates a journal, and removes an incomplete last line. Throws OutputError if an existing
  /// journal belongs to another `study`, if the file cannot be read or written, or if another process writes
  /// the journal. On a file system without locks, another process that writes the journal is not detected.
  ///
  /// study: a text that identifies the study, its world and the version of the program
  /// facts: what has been combined to this text. The error for another study names those that differ
  ///
  /// A new journal stores both.
  SweepJournal(const std::filesystem::path& file, std::string_view study, const StudyFacts& facts = {});

  /// Appends the result of a finished run. When add() returns, the result is on the disk. Throws
  /// std::runtime_error if writing fails; the journal then has no part of the result.
  void add(const SweepOutcome& outcome);
  /// Appends the error of a failed run, whose index in the study is `run`. Like add(), it returns when the
  /// error is on the disk, and throws std::runtime_error if writing fails.
  void add_failure(std::size_t run, const std::string& error);

 private:
  void append(std::size_t run, std::string line);

  std::filesystem::path file_;
  worldio::Descriptor descriptor_;
};

/// Returns the results in all journals of a folder, which must exist. If a run failed and a later call of
/// `troupe sweep` finished it, the error is left out. An incomplete last line of a journal is ignored. Throws
/// OutputError if a journal cannot be read, belongs to another `study`, has a damaged line, or has a line
/// that does not fit `size`.
///
/// study, facts: as for SweepJournal
SweepResults read_journals(const std::filesystem::path& folder, std::string_view study, const SweepSize& size,
                           const StudyFacts& facts = {});

/// Returns the path of the journal of one process. The runs of a study can be divided into parts (--part),
/// each of which one process makes: `part` is the number of the part, from 1 to `parts`.
std::filesystem::path journal_file(const std::filesystem::path& folder, std::size_t part, std::size_t parts);

}  // namespace troupe::apps
