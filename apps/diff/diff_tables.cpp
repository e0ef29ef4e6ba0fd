#include "apps/diff/diff_tables.hpp"

#include "apps/numbers.hpp"
#include "apps/sweep/table.hpp"
#include "base/diagnostics.hpp"
#include "base/split.hpp"
#include "worldio/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t k_most_rows = 20;  // that are printed

using Cells = std::vector<std::string>;

/// Removes the first row of a CSV text, with its line end, and returns its cells. Quotes are as csv_cell()
/// writes them.
Cells take_row(std::string_view& text) {
  Cells cells(1);
  bool is_quoted = false;
  std::size_t at = 0;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '"' && is_quoted && text.substr(at + 1, 1) == "\"") {
      cells.back() += text[++at];
    } else if (c == '"') {
      is_quoted = !is_quoted;
    } else if (c == ',' && !is_quoted) {
      cells.emplace_back();
    } else if (c == '\n' && !is_quoted) {
      break;
    } else {
      cells.back() += c;
    }
  }
  text.remove_prefix(std::min(text.size(), at + 1));
  if (cells.back().ends_with('\r')) cells.back().pop_back();
  return cells;
}

struct Table {
  Cells columns;
  std::map<std::string, Cells, std::less<>> rows;  // by the first cell, the number of the run
  std::vector<std::string> order;                  // the numbers of the runs, as in the file
};

Table read_table(const fs::path& file) {
  const std::optional<std::string> content = worldio::read_file(file);
  if (!content || !is_start_of_results(*content)) {
    const Result<> readable = worldio::check_readable(file, worldio::k_most_input_bytes);
    throw InputError(fmt::format(
        "{}: error: {}", file.string(),
        !readable ? readable.error().text : "this is not a table of troupe sweep, which the other file is"));
  }
  std::string_view text = *content;
  Table table{.columns = take_row(text)};
  for (std::size_t number = 2; !text.empty(); ++number) {
    Cells row = take_row(text);
    if (row.size() != table.columns.size())
      throw InputError(fmt::format("{}: error: row {} has {} cells, but there are {} columns", file.string(),
                                   number, row.size(), table.columns.size()));
    if (table.rows.contains(row[0]))
      throw InputError(fmt::format("{}: error: run {} has two rows", file.string(), row[0]));
    table.order.push_back(row[0]);
    table.rows.emplace(row[0], std::move(row));
  }
  return table;
}

/// Returns the columns of `a` that `b` lacks.
Cells columns_without(const Table& a, const Table& b) {
  Cells missing;
  for (const std::string& column : a.columns)
    if (std::ranges::find(b.columns, column) == b.columns.end()) missing.push_back(column);
  return missing;
}

/// Returns the differences of two rows in the columns of both tables: `coverage 0.1 and 0.2`.
std::string row_difference(const Table& a, const Cells& row_a, const Table& b, const Cells& row_b) {
  std::vector<std::string> differing;
  for (std::size_t i = 0; i < a.columns.size(); ++i) {
    const auto j = std::ranges::find(b.columns, a.columns[i]) - b.columns.begin();
    if (static_cast<std::size_t>(j) == b.columns.size()) continue;
    const std::string& other = row_b[static_cast<std::size_t>(j)];
    if (row_a[i] != other) differing.push_back(fmt::format("{} {} and {}", a.columns[i], row_a[i], other));
  }
  return joined(differing, ", ");
}

}  // namespace

bool is_results_table(const fs::path& file) {
  constexpr std::size_t k_header_bytes = 1 << 20;  // for the column names of a table with many parameters
  return is_start_of_results(worldio::start_of(file, k_header_bytes));
}

ExitCode diff_tables(const DiffOptions& options) {
  const Table a = read_table(options.first);
  const Table b = read_table(options.second);
  std::vector<std::string> lines;
  const auto only_in = [&lines](std::string_view what, const Cells& names, const fs::path& file) {
    if (!names.empty())
      lines.push_back(fmt::format("only in {}: {} {}", file.string(), what, joined(names, ", ")));
  };
  only_in("column", columns_without(a, b), options.first);
  only_in("column", columns_without(b, a), options.second);
  Cells only_a, only_b;
  std::size_t differing = 0, common = 0;
  for (const std::string& run : a.order) {
    const auto other = b.rows.find(run);
    if (other == b.rows.end()) {
      only_a.push_back(run);
      continue;
    }
    ++common;
    const std::string difference = row_difference(a, a.rows.at(run), b, other->second);
    if (difference.empty()) continue;
    if (++differing <= k_most_rows) lines.push_back(fmt::format("run {}: {}", run, difference));
  }
  for (const std::string& run : b.order)
    if (!a.rows.contains(run)) only_b.push_back(run);
  if (differing > k_most_rows) lines.push_back(fmt::format("and {} more rows", differing - k_most_rows));
  only_in("run", only_a, options.first);
  only_in("run", only_b, options.second);
  if (lines.empty()) {
    fmt::print("same rows: {} of {}\n", counted(common, "run"), counted(a.columns.size(), "column"));
    return k_finished;
  }
  fmt::print("differs in {} of {}:\n", differing, counted(common, "common row"));
  for (const std::string& line : lines) fmt::print("  {}\n", line);
  return k_failed;
}

}  // namespace troupe::apps
