#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace troupe::apps {

/// A table of a run that is written while it goes on: comma-separated values as pandas reads them without
/// options, a line of names first, and in every line the tick first. What has been flushed is whole lines.
class CsvFile {
 public:
  /// Makes the file, whatever was there, and begins it with the line of names. Throws OutputError.
  CsvFile(const std::filesystem::path& file, std::string_view header);
  /// Goes on with a table of an earlier run: keeps its lines whose tick is below `keep_before`, and drops
  /// what follows, a line that was cut off too. Makes a new file where there is none. Throws OutputError, and
  /// leaves the file as it is, where it is no such table.
  CsvFile(const std::filesystem::path& file, std::string_view header, std::uint64_t keep_before);

  /// Appends to the line that has been begun: the shortest text that is read back as the same number, `nan`
  /// where there is none.
  CsvFile& add(double number);
  CsvFile& add(std::uint64_t number);
  /// In quotes where it needs them.
  CsvFile& add(std::string_view text);
  void end_line();

  /// Gives the lines that have ended to the file. Throws std::runtime_error, with the file's name and the
  /// tick, where they cannot be written.
  void flush(std::uint64_t tick);

 private:
  void separate();

  std::filesystem::path file_;
  std::ofstream stream_;
  std::string pending_;
  bool line_begun_ = false;
};

/// A text as a cell of a table: in quotes where it holds a comma, a quote or a line's end (RFC 4180).
std::string csv_cell(std::string_view text);

}  // namespace troupe::apps
