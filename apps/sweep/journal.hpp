#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::apps {

/// What one run of a study came to.
struct SweepOutcome {
  std::size_t run = 0;
  std::uint64_t seed = 0;
  std::uint64_t ticks = 0;
  double time_s = 0;
  std::vector<double> values;  ///< a number a column of measures; NaN where there is none
  std::string state_hash;
};

/// The runs that one process has finished: a line of JSON each, on the disk before the next one begins, so
/// that a sweep that is killed loses what was under way and nothing else.
class SweepJournal {
 public:
  /// Opens a journal, or begins it; a line that was cut off is dropped. `study` says which study, of which
  /// world, by which program: it must be that of the journal. Throws OutputError, also where another process
  /// writes it.
  SweepJournal(const std::filesystem::path& file, std::string_view study);
  ~SweepJournal();
  SweepJournal(const SweepJournal&) = delete;
  SweepJournal& operator=(const SweepJournal&) = delete;

  /// Throws std::runtime_error where it cannot be written.
  void add(const SweepOutcome& outcome);

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

/// The outcomes in all journals of a folder, by run. Throws OutputError where one is of another study.
std::map<std::size_t, SweepOutcome> read_journals(const std::filesystem::path& folder,
                                                  std::string_view study);

/// The journal of part i of n, counted from 1.
std::filesystem::path journal_file(const std::filesystem::path& folder, std::size_t part, std::size_t parts);

}  // namespace troupe::apps
