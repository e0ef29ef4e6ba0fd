#include "apps/sweep/table.hpp"

#include "apps/csv.hpp"
#include "apps/outputs.hpp"
#include "base/diagnostics.hpp"
#include "base/number_text.hpp"
#include "worldio/files.hpp"
#include "worldio/partial_file.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <sstream>
#include <string_view>
#include <system_error>
#include <variant>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

using Numbers = std::vector<double>;
using Counts = std::vector<std::uint64_t>;
using Texts = std::vector<std::string>;

constexpr std::string_view k_error_column = "error";
constexpr std::size_t k_longest_error = 200;  // in table.h5, bytes

struct Column {
  std::string name;
  std::variant<Numbers, Counts, Texts> cells;  // one per run
};

/// Whether `number`, which was read from `text`, is the number in the text. A whole number above 2^53 may
/// have no equal double; fractions are rounded in any case.
bool is_exact(const std::string& text, double number) {
  return text.find_first_not_of("-0123456789") != text.npos || fmt::format("{:.0f}", number) == text;
}

/// Returns a column with the values of a parameter or with seeds. values: the JSON text of the value in each
/// run, or "nan" for an unknown seed. If all texts are numbers, the column contains numbers, else texts. It
/// also contains texts if a whole number would be rounded.
Column column_of(const std::string& name, const Texts& values) {
  Numbers numbers;
  Counts counts;
  Texts texts;
  for (const std::string& value : values) {
    texts.push_back(shown_value(value));
    if (const auto number = number_of<double>(value); number && is_exact(value, *number))
      numbers.push_back(*number);
    if (const auto count = number_of<std::uint64_t>(value)) counts.push_back(*count);
  }
  if (numbers.size() == texts.size()) return {name, std::move(numbers)};
  if (counts.size() == texts.size()) return {name, std::move(counts)};
  return {name, std::move(texts)};
}

/// Returns the column of the seeds. std::nullopt stands for an unknown seed.
Column seed_column(const std::vector<std::optional<std::uint64_t>>& seeds) {
  Counts known;
  Texts texts;
  for (const std::optional<std::uint64_t>& seed : seeds) {
    if (seed) known.push_back(*seed);
    texts.push_back(seed ? fmt::to_string(*seed) : "nan");
  }
  if (known.size() == seeds.size()) return {"seed", std::move(known)};
  return column_of("seed", texts);
}

/// Returns a simulated time as the tables contain it, s.
double rounded_time(double time_s) { return number_of<double>(time_cell(time_s)).value_or(time_s); }

/// Returns the columns of the table, with one cell per run.
std::vector<Column> columns_of(const SweepTable& table) {
  constexpr double k_none = std::numeric_limits<double>::quiet_NaN();
  const std::size_t runs = table.study.run_count();
  Counts index, ticks;
  std::vector<std::optional<std::uint64_t>> seeds;
  Numbers times;
  Texts conditions, hashes, errors;
  std::vector<Texts> values(table.study.parameters.size());
  std::vector<Numbers> measures(table.measures.size());
  for (std::size_t r = 0; r < runs; ++r) {
    const worldio::Study::Run run = table.study.run(r);
    for (std::size_t p = 0; p < values.size(); ++p) values[p].push_back(run.values[p]);
    const auto found = table.results.outcomes.find(r);
    const auto failed = table.results.failed.find(r);
    const bool is_there = found != table.results.outcomes.end();
    index.push_back(r);
    seeds.push_back(is_there ? found->second.seed : table.study.seed_of(run, table.world_seed));
    ticks.push_back(is_there ? found->second.ticks : 0);
    times.push_back(is_there ? rounded_time(found->second.time_s) : k_none);
    conditions.push_back(is_there ? found->second.stopped_by : "");
    hashes.push_back(is_there ? found->second.state_hash : "");
    errors.push_back(failed == table.results.failed.end() ? "" : failed->second);
    for (std::size_t m = 0; m < measures.size(); ++m)
      measures[m].push_back(is_there ? found->second.values[m] : k_none);
  }
  std::vector<Column> columns{{"run", std::move(index)}};
  for (std::size_t p = 0; p < table.study.parameters.size(); ++p)
    columns.push_back(column_of(table.study.parameters[p].name, values[p]));
  columns.push_back(seed_column(seeds));
  columns.push_back({"ticks", std::move(ticks)});
  columns.push_back({"time_s", std::move(times)});
  for (std::size_t m = 0; m < measures.size(); ++m)
    columns.push_back({table.measures[m], std::move(measures[m])});
  columns.push_back({"stopped_by", std::move(conditions)});
  columns.push_back({"state_hash", std::move(hashes)});
  columns.push_back({std::string(k_error_column), std::move(errors)});
  return columns;
}

std::string cell_of(const Column& column, std::size_t row) {
  if (const auto* numbers = std::get_if<Numbers>(&column.cells)) return number_cell((*numbers)[row]);
  if (const auto* counts = std::get_if<Counts>(&column.cells)) return fmt::format("{}", (*counts)[row]);
  return csv_cell(std::get<Texts>(column.cells)[row]);
}

/// Returns an error with at most k_longest_error bytes: its beginning, in whole characters, and "...".
std::string cut_error(const std::string& error) {
  constexpr std::string_view k_dots = "...";
  if (error.size() <= k_longest_error) return error;
  return std::string(first_characters(error, k_longest_error - k_dots.size())).append(k_dots);
}

}  // namespace

std::string shown_value(const std::string& json) {
  const bool quoted = json.size() >= 2 && json.front() == '"' && json.find('\\') == json.npos;
  return quoted ? json.substr(1, json.size() - 2) : json;
}

void write_csv(const SweepTable& table, const fs::path& file) {
  const std::vector<Column> columns = columns_of(table);
  std::string text;
  for (const Column& column : columns)
    text += fmt::format("{}{}", text.empty() ? "" : ",", csv_cell(column.name));
  text += '\n';
  for (std::size_t row = 0; row < table.study.run_count(); ++row)
    for (const Column& column : columns)
      text += fmt::format("{}{}", cell_of(column, row), &column == &columns.back() ? '\n' : ',');
  write_output(file, {text});
}

bool is_start_of_results(std::string_view start) {
  bool is_quoted = false;  // names of columns in quotes may have line breaks
  const auto is_end = [&](char c) {
    if (c == '"') is_quoted = !is_quoted;
    return c == '\n' && !is_quoted;
  };
  const std::string_view columns(start.begin(), std::ranges::find_if(start, is_end));
  return columns.starts_with(k_results_mark) && columns.find(",seed,ticks,time_s,") != columns.npos;
}

fs::path series_file(const fs::path& folder, std::size_t run) {
  return folder / "series" / fmt::format("{}.csv", run);
}

std::optional<std::string> series_rows(const fs::path& folder, const SweepOutcome& outcome) {
  const std::optional<std::string> text = worldio::read_file(series_file(folder, outcome.run));
  if (!text || !text->ends_with('\n')) return std::nullopt;
  const std::string run = fmt::format("{},", outcome.run);
  std::string rows, time;
  std::istringstream lines(*text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t end = std::min(line.find(',', std::min(run.size(), line.size())), line.size());
    if (!line.starts_with(run)) return std::nullopt;
    const auto time_s = number_of<double>(std::string_view(line).substr(run.size(), end - run.size()));
    if (!time_s) return std::nullopt;
    time = time_cell(*time_s);
    rows.append(run).append(time).append(line, end).append(1, '\n');
  }
  if (time != time_cell(outcome.time_s)) return std::nullopt;
  return rows;
}

void add_series_row(std::string& rows, std::size_t run, double time_s, const std::vector<double>& values) {
  rows += fmt::format("{},{}", run, time_cell(time_s));
  for (const double value : values) rows.append(1, ',').append(number_cell(value));
  rows += '\n';
}

void write_series(const SweepTable& table, const std::vector<std::string>& measures, const fs::path& folder) {
  const fs::path file = folder / "series.csv";
  try {
    worldio::PartialFile whole(file);
    const auto write = [&whole](const std::string& text) { whole.write(std::as_bytes(std::span(text))); };
    std::string head(k_series_mark);
    for (const std::string& measure : measures) head += "," + csv_cell(measure);
    write(head + "\n");
    for (const auto& [run, outcome] : table.results.outcomes) {  // in the order of runs
      const std::optional<std::string> rows = series_rows(folder, outcome);
      if (!rows)
        throw OutputError(fmt::format(
            "{}: error: the file with the samples of run {} is missing, incomplete or unreadable: "
            "repeat the command, which makes the run again",
            series_file(folder, run).string(), run));
      write(*rows);
    }
    whole.commit_to_disk();
  } catch (const std::system_error& error) {
    refuse_output(file, error.code().message());
  }
}

void write_hdf5(const SweepTable& table, const fs::path& file) {
  worldio::Hdf5File hdf5 = worldio::Hdf5File::create_in_memory(file);
  {
    worldio::Hdf5Group group = hdf5.create_group("table");
    for (const auto& [name, value] : table.facts) group.set_text(name, value);
    Texts names;
    for (Column& column : columns_of(table)) {
      if (column.name == k_error_column)
        for (std::string& error : std::get<Texts>(column.cells)) error = cut_error(error);
      names.push_back(column.name);
      const std::string name = worldio::hdf5_name(column.name);
      if (const auto* numbers = std::get_if<Numbers>(&column.cells))
        group.write(name, std::span<const double>(*numbers));
      else if (const auto* counts = std::get_if<Counts>(&column.cells))
        group.write(name, std::span<const std::uint64_t>(*counts));
      else
        group.write_texts(name, std::get<Texts>(column.cells));
    }
    hdf5.write_texts("columns", names);
  }
  const std::vector<std::byte> image = hdf5.image();
  write_output(file, {std::string_view(reinterpret_cast<const char*>(image.data()), image.size())});
}

bool is_hdf5_table(const worldio::Hdf5File& file) { return file.has_group("table") && file.has("columns"); }

}  // namespace troupe::apps
