#include "apps/csv.hpp"

#include "apps/options.hpp"
#include "apps/outputs.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <iterator>
#include <stdexcept>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

/// Returns the number of bytes of a table before its first line whose tick is at least `keep_before`. Throws
/// OutputError if the file is not a table with this header.
std::uintmax_t bytes_to_keep(const fs::path& file, std::string_view header, std::uint64_t keep_before) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) refuse_output(file, std::strerror(errno));
  std::string line;
  // An incomplete last line does not count.
  const auto next = [&] { return std::getline(stream, line) && !stream.eof(); };
  if (!next() || line != header)
    refuse_output(file, fmt::format("this table cannot be continued after the checkpoint, because its first "
                                    "line is not \"{}\": choose another file",
                                    header));
  std::uintmax_t bytes = line.size() + 1;
  while (next()) {
    const auto tick = number<std::uint64_t>(std::string_view(line).substr(0, line.find(',')));
    if (!tick)
      refuse_output(file, fmt::format("this table cannot be continued after the checkpoint, because one of "
                                      "its lines does not begin with a tick (\"{}\"): choose another file",
                                      line));
    if (*tick >= keep_before) break;
    bytes += line.size() + 1;
  }
  return bytes;
}

}  // namespace

CsvFile::CsvFile(const fs::path& file, std::string_view header)
    : file_(file), stream_(file, std::ios::binary) {
  if (!stream_) refuse_output(file, std::strerror(errno));
  pending_ = fmt::format("{}\n", header);
}

CsvFile::CsvFile(const fs::path& file, std::string_view header, std::uint64_t keep_before) : file_(file) {
  std::error_code ignored;
  const bool is_new = !fs::exists(file, ignored);
  if (!is_new) fs::resize_file(file, bytes_to_keep(file, header, keep_before));
  stream_.open(file, std::ios::binary | std::ios::app);
  if (!stream_) refuse_output(file, std::strerror(errno));
  if (is_new) pending_ = fmt::format("{}\n", header);
}

void CsvFile::separate() {
  if (line_begun_) pending_ += ',';
  line_begun_ = true;
}

CsvFile& CsvFile::add(double number) {
  separate();
  if (std::isnan(number)) {  // of either sign
    pending_ += "nan";
    return *this;
  }
  std::array<char, 32> text;  // the longest is -2.2250738585072014e-308
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
  pending_.append(text.data(), end);
  return *this;
}

CsvFile& CsvFile::add(std::uint64_t number) {
  separate();
  fmt::format_to(std::back_inserter(pending_), "{}", number);
  return *this;
}

CsvFile& CsvFile::add(std::string_view text) {
  separate();
  pending_ += csv_cell(text);
  return *this;
}

void CsvFile::end_line() {
  pending_ += '\n';
  line_begun_ = false;
}

void CsvFile::flush(std::uint64_t tick) {
  if (pending_.empty()) return;
  stream_ << pending_ << std::flush;
  pending_.clear();
  if (!stream_)
    throw std::runtime_error(
        fmt::format("{}: error: writing failed at tick {}: {}", file_.string(), tick, std::strerror(errno)));
}

std::string csv_cell(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == text.npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace troupe::apps
