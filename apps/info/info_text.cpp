// Summaries of text files: hash logs, tables, profiles, journals, sessions, and JSON files, which are worlds
// or studies. Hash logs, tables, profiles and journals may be large and are read line by line.

#include "apps/hash_log_reader.hpp"
#include "apps/info/info_kinds.hpp"
#include "apps/observers/tables.hpp"
#include "base/diagnostics.hpp"
#include "base/hash.hpp"
#include "base/number_text.hpp"
#include "base/split.hpp"
#include "engine/kinds/act.hpp"
#include "worldio/json/session_json.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <string_view>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

constexpr const char* k_whole = "yes";

/// Reads a file line by line. A last line without a line break is incomplete and is not returned.
class Lines {
 public:
  explicit Lines(const fs::path& file) : stream_(file, std::ios::binary) {
    if (!stream_) throw InputError(fmt::format("{}: error: cannot be read", file.string()));
  }

  /// Reads the next complete line into `line`, without its line end (LF or CR LF). Returns false if there is
  /// none.
  bool next(std::string& line) {
    if (!std::getline(stream_, line)) return false;
    ++number_;
    cut_off_ = stream_.eof();
    if (line.ends_with('\r')) line.pop_back();
    return !cut_off_;
  }
  /// Reads the next complete row of a table into `row`: a line, and the lines after it as long as a quoted
  /// cell is open. Returns false if there is none.
  bool next_row(std::string& row) {
    if (!next(row)) return false;
    for (std::string line; std::ranges::count(row, '"') % 2 == 1; row += '\n' + line)
      if (!next(line)) {
        cut_off_ = true;
        return false;
      }
    return true;
  }
  std::size_t number() const { return number_; }
  /// The value of "complete" in the summary.
  std::string whole_text() const {
    return cut_off_ ? fmt::format("no: cut off in line {}", number_) : k_whole;
  }

 private:
  std::ifstream stream_;
  std::size_t number_ = 0;
  bool cut_off_ = false;
};

/// Returns the first `count` cells of a row of a table, or all cells if it has fewer. The cells must have no
/// quotes.
std::vector<std::string_view> first_cells(std::string_view line, std::size_t count) {
  std::vector<std::string_view> cells;
  while (cells.size() < count) {
    const std::size_t comma = line.find(',');
    cells.push_back(line.substr(0, comma));
    if (comma == line.npos) break;
    line.remove_prefix(comma + 1);
  }
  return cells;
}

/// The first two cells of a line of a table: tick and simulated time, s.
struct Span {
  std::uint64_t tick = 0;
  double time_s = 0;
};

Span span_of(const fs::path& file, const Lines& lines, const std::vector<std::string_view>& cells) {
  const auto tick = number_of<std::uint64_t>(cells[0]);
  const auto time_s = cells.size() > 1 ? finite_number_of(cells[1]) : std::nullopt;
  if (!tick || !time_s)
    throw InputError(
        fmt::format("{}:{}: error: the line must begin with a tick and a time in seconds, found \"{}\"",
                    file.string(), lines.number(), joined(cells, ",").substr(0, 60)));
  return {*tick, *time_s};
}

/// How often each kind of event or action occurs, by its name.
using NamedCounts = std::map<std::string, std::size_t, std::less<>>;

void add_counts(const NamedCounts& counts, Summary& summary) {
  for (const auto& [kind, times] : counts) summary.emplace_back("  " + kind, fmt::format("{}", times));
}

/// Counts the lines of a table and keeps the spans of the first and the last line.
struct TableSpan {
  std::size_t lines = 0;
  Span first;
  Span last;

  void add(const Span& span) {
    if (lines++ == 0) first = span;
    last = span;
  }
  std::string text() const {
    return lines > 0 ? ticks_text(first.tick, last.tick, first.time_s, last.time_s) : "none";
  }
};

}  // namespace

std::string ticks_text(std::uint64_t first, std::uint64_t last, double first_s, double last_s) {
  return fmt::format("{} to {}, {:.10g} to {:.10g} s", first, last, first_s, last_s);
}

Summary summary_of_hash_log(const fs::path& file) {
  HashLogReader log(file);
  Summary summary{{"kind", "hash log, format 1"}};
  const auto header = [&](const std::string& key) {
    const auto found = log.header().entries.find(key);
    return found == log.header().entries.end() ? std::string() : found->second.value;
  };
  if (const std::string version = header("version"); !version.empty())
    summary.emplace_back("written by", version);
  for (const auto& [key, value] : log.header().entries)
    if (key != "version") summary.emplace_back(key, value.value);

  std::optional<std::uint64_t> first;
  HashLogReader::Line last{};
  std::string whole = k_whole;
  try {
    while (const auto line = log.next()) {
      if (!first) first = line->tick;
      last = *line;
    }
  } catch (const InputError& error) {
    whole = fmt::format("no: {}", error.what());
  }
  if (first) {
    const double tick_s = finite_number_of(header("tick_s")).value_or(0);
    summary.emplace_back("ticks", ticks_text(*first, last.tick, static_cast<double>(*first) * tick_s,
                                             static_cast<double>(last.tick) * tick_s));
    summary.emplace_back("last state", hex(last.state));
  } else {
    summary.emplace_back("ticks", "none");
  }
  summary.emplace_back("complete", whole);
  return summary;
}

Summary summary_of_measures(const fs::path& file) {
  Lines lines(file);
  Summary summary{{"kind", "table of measures"}};
  std::string line;
  if (lines.next_row(line)) {
    std::string columns = line.substr(std::min(line.size(), k_measures_mark.size()));
    summary.emplace_back("measures", columns);
  }
  TableSpan table;
  while (lines.next_row(line)) table.add(span_of(file, lines, first_cells(line, 2)));
  summary.emplace_back("lines", fmt::format("{}", table.lines));
  summary.emplace_back("ticks", table.text());
  summary.emplace_back("complete", lines.whole_text());
  return summary;
}

Summary summary_of_events(const fs::path& file) {
  Lines lines(file);
  Summary summary{{"kind", "table of events"}};
  std::string line;
  lines.next_row(line);
  TableSpan table;
  NamedCounts kinds;
  while (lines.next_row(line)) {
    const std::vector<std::string_view> cells = first_cells(line, 3);
    table.add(span_of(file, lines, cells));
    if (cells.size() > 2) ++kinds[std::string(cells[2])];
  }
  summary.emplace_back("events", fmt::format("{}", table.lines));
  add_counts(kinds, summary);
  summary.emplace_back("ticks", table.text());
  summary.emplace_back("complete", lines.whole_text());
  return summary;
}

void add_runs(std::size_t runs, std::size_t failed, Summary& summary) {
  summary.emplace_back(
      "runs", failed == 0 ? fmt::format("{}", runs)
                          : fmt::format("{}, of which {} failed: see the column \"error\"", runs, failed));
}

Summary summary_of_results(const fs::path& file) {
  Lines lines(file);
  Summary summary{{"kind", "table of the results of a sweep"}};
  std::string line;
  if (lines.next_row(line)) summary.emplace_back("columns", line);
  std::size_t runs = 0;
  std::size_t failed = 0;
  for (; lines.next_row(line); ++runs)
    if (!line.ends_with(',')) ++failed;  // the last column is `error`
  add_runs(runs, failed, summary);
  summary.emplace_back("complete", lines.whole_text());
  return summary;
}

Summary summary_of_series(const fs::path& file) {
  Lines lines(file);
  Summary summary{{"kind", "measures over time of the runs of a sweep"}};
  std::string line;
  if (lines.next_row(line)) summary.emplace_back("columns", line);
  std::size_t count = 0;
  std::size_t runs = 0;
  for (std::string run; lines.next_row(line); ++count) {  // the rows of a run are adjacent
    const std::string_view cell = first_cells(line, 1).front();
    if (count == 0 || cell != run) ++runs;
    run = cell;
  }
  summary.emplace_back("runs", fmt::format("{}", runs));
  summary.emplace_back("lines", fmt::format("{}", count));
  summary.emplace_back("complete", lines.whole_text());
  return summary;
}

Summary summary_of_journal(const fs::path& file) {
  Lines lines(file);
  std::string line;
  lines.next(line);
  Summary summary{
      {"kind", "journal of a sweep: the results of its runs, which troupe sweep writes into tables"}};
  const auto head = nlohmann::ordered_json::parse(line, nullptr, false);
  for (const auto& [name, value] : head.items())
    if (value.is_string() && name != "study")
      summary.emplace_back(name == "version" ? "written by" : name, value.get<std::string>());
  std::set<std::size_t> finished, failed;
  while (lines.next(line)) {
    const auto json = nlohmann::json::parse(line, nullptr, false);
    if (!json.is_object() || !json.contains("run") || !json["run"].is_number_unsigned())
      throw InputError(fmt::format("{}:{}: error: not a result that troupe sweep writes: the file is damaged",
                                   file.string(), lines.number()));
    (json.contains("error") ? failed : finished).insert(json["run"].get<std::size_t>());
  }
  for (const std::size_t run : finished) failed.erase(run);  // a later sweep finished it
  summary.emplace_back("finished runs", fmt::format("{}", finished.size()));
  summary.emplace_back("failed runs", fmt::format("{}", failed.size()));
  summary.emplace_back("complete", lines.whole_text());
  return summary;
}

std::optional<Summary> summary_of_json(const fs::path& file, const std::string& text,
                                       const KindSources& sources) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  // In invalid JSON, the key may be anywhere: the reader of worlds or studies then reports the error.
  const auto has = [&](const std::string& key) {
    return json.is_discarded() ? text.find('"' + key + '"') != text.npos
                               : json.is_object() && json.contains(key);
  };
  if (has("troupe_study")) return summary_of_study(file, text, sources);
  if (has("troupe")) return summary_of_world(file, text, true, sources);
  return std::nullopt;
}

Summary summary_of_session(const fs::path& file) {
  const worldio::Session session = worldio::load_session(file);
  Summary summary{{"kind", fmt::format("session, format {}", worldio::k_session_format)},
                  {"written by", session.header.version}};
  for (const auto& [name, value] : session.header.options) summary.emplace_back(name, value);
  summary.emplace_back("actions", fmt::format("{}", session.acts.size()));
  NamedCounts kinds;
  for (const worldio::LoggedAct& logged : session.acts)
    ++kinds[std::string(engine::k_acts[static_cast<std::size_t>(logged.act.kind)])];
  add_counts(kinds, summary);
  std::uint64_t last = session.header.tick;
  if (!session.acts.empty()) last = session.acts.back().tick;
  summary.emplace_back("ticks", fmt::format("{} to {}", session.header.tick, session.end.value_or(last)));
  summary.emplace_back("complete", session.end ? k_whole : "no: the line that ends the session is missing");
  return summary;
}

Summary summary_of_profile(const fs::path& file) {
  constexpr std::string_view k_about = "],\"otherData\":";
  Lines lines(file);
  Summary summary{{"kind", "profile, in the Trace Event Format"}};
  std::size_t ticks = 0;
  std::size_t events = 0;
  std::string about;
  for (std::string line; lines.next(line);) {
    events += line.starts_with("{\"name\":");
    ticks += line.starts_with("{\"name\":\"tick\",");
    if (line.starts_with(k_about)) about = line.substr(k_about.size());
  }
  std::string whole = "no: cut off";
  if (!about.empty()) {
    about.pop_back();  // the closing brace of the document
    const auto headers = nlohmann::ordered_json::parse(about, nullptr, false);
    if (headers.is_object()) whole = k_whole;
    for (const auto& [key, value] : headers.items())
      summary.emplace_back(key == "version" ? "written by" : key,
                           value.is_string() ? value.get<std::string>() : value.dump());
  }
  summary.emplace_back("ticks", fmt::format("{}", ticks));
  summary.emplace_back("events", fmt::format("{}", events));
  summary.emplace_back("complete", whole);
  return summary;
}

}  // namespace troupe::apps
