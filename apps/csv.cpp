#include "apps/csv.hpp"

#include "apps/outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <span>

namespace troupe::apps {
namespace fs = std::filesystem;

CsvFile::CsvFile(const fs::path& file, std::string_view header)
    : file_(file), pending_(fmt::format("{}\n", header)) {}

CsvFile::CsvFile(const fs::path& file, std::string_view header, const std::optional<Start>& start)
    : file_(file), goes_on_(true) {
  const auto fail = [&](std::string_view reason) {
    refuse_output(file, fmt::format("this table cannot be continued after the checkpoint, because {}: choose "
                                    "another file",
                                    reason));
  };
  std::ifstream old(file, std::ios::binary);
  if (!old) refuse_output(file, std::strerror(errno));
  const std::string first = fmt::format("{}\n", header);
  std::string found(first.size(), '\0');
  if (!old.read(found.data(), static_cast<std::streamsize>(found.size())) || found != first)
    fail(fmt::format("its first line is not \"{}\"", header));
  if (!start) fail("the checkpoint was saved by a run without this table");
  old.seekg(0);
  for (std::string piece(1 << 16, '\0'); written_.bytes < start->bytes && old;) {
    old.read(piece.data(), static_cast<std::streamsize>(
                               std::min<std::uint64_t>(start->bytes - written_.bytes, piece.size())));
    count({piece.data(), static_cast<std::size_t>(old.gcount())});
  }
  if (written_ != *start) fail("it is not the table that the run had written when the checkpoint was saved");
  if (start->bytes == 0) pending_ = first;
}

void CsvFile::open() {
  lock_ =
      open_output(stream_, file_, goes_on_ ? std::optional<std::uintmax_t>(written_.bytes) : std::nullopt);
}

void CsvFile::count(std::string_view text) {
  hash_.add(std::as_bytes(std::span(text)));
  written_ = {written_.bytes + text.size(), hash_.hash()};
}

void CsvFile::separate() {
  if (line_begun_) pending_ += ',';
  line_begun_ = true;
}

CsvFile& CsvFile::add(double number) {
  separate();
  pending_ += number_cell(number);
  return *this;
}

CsvFile& CsvFile::add(std::uint64_t number) {
  separate();
  pending_ += std::to_string(number);
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
  if (!stream_) throw_write_error(stream_, file_, written_.bytes, tick);
  if (tick != last_tick_) before_ = written_;
  last_tick_ = tick;
  count(pending_);
  pending_.clear();
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

std::string number_cell(double number) {
  return std::isnan(number) ? "nan" : fmt::format("{}", number);  // fmt writes -nan for some NaNs
}

std::string time_cell(double time_s) { return fmt::format("{:.12g}", time_s); }

}  // namespace troupe::apps
