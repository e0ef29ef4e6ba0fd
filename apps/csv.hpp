#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace troupe::apps {

/// A table that is written during a run, as comma-separated values that pandas reads without options. The
/// first line has the column names, and the first column is the tick. All lines, also the first, stay in
/// memory until flush(), so that the file contains only whole lines.
class CsvFile {
 public:
  /// Creates or empties the file. `header` is the line of column names, without line break. Throws
  /// OutputError if the file cannot be opened.
  CsvFile(const std::filesystem::path& file, std::string_view header);
  /// Continues the table of an earlier run. Keeps the lines before the first line whose tick is at least
  /// `keep_before`. Removes all other lines and an incomplete last line. Creates the file if it does not
  /// exist. Throws OutputError, and does not change the file, if its first line is not `header` or a line to
  /// keep does not begin with a tick.
  CsvFile(const std::filesystem::path& file, std::string_view header, std::uint64_t keep_before);

  /// Appends a number as a cell to the current line. A double is written as the shortest text that reads back
  /// as the same number, or as `inf`, `-inf` or `nan`.
  CsvFile& add(double number);
  CsvFile& add(std::uint64_t number);
  /// Appends a cell, in quotes if necessary (csv_cell()).
  CsvFile& add(std::string_view text);
  void end_line();  ///< ends the current line

  /// Writes the finished lines to the file. Call it only after end_line(), not within a line. tick: the
  /// current tick of the run, for the error. Throws std::runtime_error if writing fails.
  void flush(std::uint64_t tick);

 private:
  void separate();

  std::filesystem::path file_;
  std::ofstream stream_;
  std::string pending_;
  bool line_begun_ = false;
};

/// Returns a text as a cell of a table. If the text contains a comma, a quote or a line break, the cell is in
/// quotes, with each quote doubled (RFC 4180).
std::string csv_cell(std::string_view text);

}  // namespace troupe::apps
