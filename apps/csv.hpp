#pragma once

#include "base/hash.hpp"
#include "worldio/results/descriptor.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

namespace troupe::apps {

/// A table that a run writes line by line, as comma-separated values (CSV). pandas can read the file without
/// options. The first line has the names of the columns. The first column is the tick (number of the
/// time step).
///
/// The constructors write nothing: open() creates the file. add() appends a cell to the current line, and
/// end_line() ends the line. The lines stay in memory until flush() writes them, so the file contains only
/// whole lines. If flush() fails, it removes what it has written of these lines, unless the file is a device
/// or a pipe.
class CsvFile {
 public:
  /// Prepares a new table. `header` is the line of column names, without line break.
  CsvFile(const std::filesystem::path& file, std::string_view header);
  /// Length and hash of the first lines of the file. A checkpoint (saved state of a run) stores these two
  /// numbers for the lines that the run had written. When the run is resumed, they show whether the file
  /// still begins with these lines.
  struct Start {
    std::uint64_t bytes = 0;  ///< length, bytes, with the line of column names
    std::uint64_t hash = 0;   ///< hash of these bytes; 0 if `bytes` is 0
    friend bool operator==(const Start&, const Start&) = default;
  };
  /// Prepares the continuation of the table of an earlier run: open() keeps the first lines, which `start`
  /// describes, and removes all later lines. Throws OutputError in these cases:
  ///
  /// - The file cannot be read.
  /// - Its first line is not `header`.
  /// - `start` is not set, because the checkpoint has no data of this table.
  /// - The length or the hash of the first lines differs from `start`.
  CsvFile(const std::filesystem::path& file, std::string_view header, const std::optional<Start>& start);

  /// Creates or empties the file of a new table, or removes the later lines of a continued table. Call it
  /// once, before flush(). Throws OutputError if the file cannot be written, or if another process is writing
  /// it.
  void open();

  /// Appends a number as a cell to the current line, a double as number_cell() writes it.
  CsvFile& add(double number);
  CsvFile& add(std::uint64_t number);
  /// Appends a cell, in quotes if necessary (csv_cell()).
  CsvFile& add(std::string_view text);
  void end_line();  ///< ends the current line

  /// Writes the lines in memory to the file. Call it only after end_line(), when no line is unfinished.
  /// Throws std::runtime_error if writing fails, and again in each later call.
  ///
  /// tick: the current tick of the run. It is stored for before(), and an error message contains it.
  void flush(std::uint64_t tick);
  /// Returns length and hash of the lines that were written by calls of flush() with ticks earlier than
  /// `tick`. `tick` must be at least the tick of the last flush().
  Start before(std::uint64_t tick) const { return last_tick_ && *last_tick_ >= tick ? before_ : written_; }

 private:
  void separate();
  void count(std::string_view text);

  std::filesystem::path file_;
  bool goes_on_ = false;  // whether the table is continued
  std::ofstream stream_;
  worldio::Descriptor lock_;
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
/// Returns a number as a cell of a table: the shortest text that reads back as the same number, or `inf`,
/// `-inf` or `nan`. Numbers with an absolute value from 0.0001 to below 1e16 have no exponent.
std::string number_cell(double number);
/// Returns a simulated time, in s, as a cell of a table, rounded to 12 significant digits. Without rounding,
/// tick 66 would be at 6.6000000000000005 s if ticks are 0.1 s long, and the same time could have different
/// texts in worlds with different lengths of ticks.
std::string time_cell(double time_s);

}  // namespace troupe::apps
