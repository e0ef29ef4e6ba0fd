#pragma once

#include "base/hash.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

namespace troupe::apps {

/// A table that is written during a run, as comma-separated values that pandas reads without options. The
/// first line has the column names, and the first column is the tick (number of the simulation step). All
/// lines, also the first, stay in memory until flush(), so that the file contains only whole lines.
class CsvFile {
 public:
  /// Creates or empties the file. `header` is the line of column names, without line break. Throws
  /// OutputError if the file cannot be opened.
  CsvFile(const std::filesystem::path& file, std::string_view header);
  /// The beginning of a table: its lines up to some tick. A checkpoint (saved state of a run) stores length
  /// and hash of this beginning, so that a resumed run detects a file that is the table of another run.
  struct Start {
    std::uint64_t bytes = 0;  ///< length of these lines, with the line of column names
    std::uint64_t hash = 0;   ///< hash of these bytes; 0 if there are none
    friend bool operator==(const Start&, const Start&) = default;
  };
  /// Continues the table of an earlier run: keeps the lines that `start` describes and removes the lines
  /// after them. Throws OutputError, and does not change the file, if the first line of the file is not
  /// `header`, if `start` is not set (the checkpoint contains no data of this table), or if the file does not
  /// begin with these lines.
  CsvFile(const std::filesystem::path& file, std::string_view header, const std::optional<Start>& start);

  /// Appends a number as a cell to the current line. A double is written as the shortest text that reads back
  /// as the same number, or as `inf`, `-inf` or `nan`.
  CsvFile& add(double number);
  CsvFile& add(std::uint64_t number);
  /// Appends a cell, in quotes if necessary (csv_cell()).
  CsvFile& add(std::string_view text);
  void end_line();  ///< ends the current line

  /// Writes the finished lines to the file. Call it only after end_line(), not within a line. tick: the
  /// current tick of the run; before() compares its argument with this tick, and an error names it. Throws
  /// std::runtime_error if writing fails.
  void flush(std::uint64_t tick);
  /// Returns length and hash of the lines that were flushed before the tick `tick`. This tick must not be
  /// earlier than the tick of the last flush.
  Start before(std::uint64_t tick) const { return last_tick_ && *last_tick_ >= tick ? before_ : written_; }

 private:
  void separate();
  void count(std::string_view text);

  std::filesystem::path file_;
  std::ofstream stream_;
  std::string pending_;
  bool line_begun_ = false;
  HashStream hash_;  // hash of the lines in the file
  Start written_;    // the lines in the file
  Start before_;     // the lines in the file, without those of last_tick_
  std::optional<std::uint64_t> last_tick_;
};

/// Returns a text as a cell of a table. If the text contains a comma, a quote or a line break, the cell is in
/// quotes, with each quote doubled (RFC 4180).
std::string csv_cell(std::string_view text);

}  // namespace troupe::apps
