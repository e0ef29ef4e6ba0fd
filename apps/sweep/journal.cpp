#include "apps/sweep/journal.hpp"

#include "apps/outputs.hpp"
#include "base/number_text.hpp"
#include "base/split.hpp"
#include "worldio/file_lock.hpp"
#include "worldio/partial_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <system_error>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view k_prefix = "runs-";
constexpr std::string_view k_ending = ".jsonl";
constexpr unsigned k_journal_mode = 0666;  // permissions of a new one, before the umask

std::string reason() { return std::generic_category().message(errno); }

std::string head_of(std::string_view study, const StudyFacts& facts) {
  Json head{{"troupe_sweep", 1}, {"study", study}};
  for (const auto& [name, value] : facts) head[name] = value;
  return head.dump();
}

/// Returns the name of a fact as it is in messages.
std::string said(const std::string& fact) {
  constexpr std::string_view k_plugin = "plugin ";
  if (fact == "version") return "version of the program";
  if (fact == "study_file") return "study file";
  return fact.starts_with(k_plugin) ? fmt::format("plug-in {}", fact.substr(k_plugin.size())) : fact;
}

/// Throws OutputError if the first line of a journal is not that of this study.
void check_head(const std::string& line, std::string_view study, const StudyFacts& facts,
                const fs::path& file) {
  const Json head = Json::parse(line, nullptr, false);
  const auto has = [&head](const std::string& name, const Json& value) {
    return head.contains(name) && head[name] == value;
  };
  if (has("troupe_sweep", 1) && has("study", study)) return;
  std::vector<std::string> differing;
  for (const auto& [name, value] : facts)  // journals of earlier versions have none
    if (head.contains(name) && !has(name, value)) differing.push_back(said(name));
  const std::string what =
      differing.empty()
          ? "of another study, of an earlier version of the world file or of a plug-in, or of another "
            "version of the program"
          : fmt::format("with another {}", joined(differing, " and another "));
  throw OutputError(fmt::format("{}: error: the folder contains runs {}: choose another folder with -o",
                                file.string(), what));
}

/// Returns the lines of a file, except a last line without a line break, which is incomplete. Throws
/// OutputError if the file cannot be read.
std::vector<std::string> whole_lines(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);)
    if (!stream.eof()) lines.push_back(line);
  if (!stream.is_open() || stream.bad())
    throw OutputError(fmt::format("{}: error: cannot be read: {}", file.string(), reason()));
  return lines;
}

/// Returns a value of a result in JSON, which has no numbers for infinities and NaN: they become texts.
Json json_value(double value) {
  if (std::isfinite(value)) return value;
  return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}

/// Returns the value that json_value() has written; std::nullopt if it is none. NaN for null, which earlier
/// versions wrote for all values that are not finite.
std::optional<double> journal_value(const Json& json) {
  if (json.is_null()) return std::numeric_limits<double>::quiet_NaN();
  if (json.is_string()) return number_of<double>(json.get<std::string>());
  if (json.is_number()) return json.get<double>();
  return std::nullopt;
}

std::string line_of(const SweepOutcome& outcome) {
  Json values = Json::array();
  for (const double value : outcome.values) values.push_back(json_value(value));
  return Json{{"run", outcome.run},
              {"seed", outcome.seed},
              {"ticks", outcome.ticks},
              {"time_s", outcome.time_s},
              {"stopped_by", outcome.stopped_by},
              {"values", values},
              {"state_hash", outcome.state_hash}}
      .dump();
}

/// Returns the result in a line of a journal. Returns std::nullopt, or throws Json::exception, if the line is
/// damaged.
std::optional<SweepOutcome> outcome_of(const Json& json) {
  SweepOutcome outcome{.run = json.at("run"),
                       .seed = json.at("seed"),
                       .ticks = json.at("ticks"),
                       .time_s = json.at("time_s"),
                       .stopped_by = json.at("stopped_by"),
                       .state_hash = json.at("state_hash")};
  for (const Json& cell : json.at("values")) {
    const std::optional<double> value = journal_value(cell);
    if (!value) return std::nullopt;
    outcome.values.push_back(*value);
  }
  return outcome;
}

/// Adds a line of a journal to `results`. Returns false if the line is damaged.
bool read_line(const std::string& line, const SweepSize& size, SweepResults& results) {
  try {
    const Json json = Json::parse(line);
    const std::size_t run = json.at("run");
    if (run >= size.runs) return false;
    if (json.contains("error")) {
      results.failed.insert_or_assign(run, json.at("error"));
      return true;
    }
    std::optional<SweepOutcome> outcome = outcome_of(json);
    if (!outcome || outcome->values.size() != size.values) return false;
    results.outcomes.insert_or_assign(run, *std::move(outcome));
    return true;
  } catch (const Json::exception&) {
    return false;
  }
}

}  // namespace

SweepJournal::SweepJournal(const fs::path& file, std::string_view study, const StudyFacts& facts)
    : file_(file), descriptor_(file, O_RDWR | O_CREAT | O_APPEND, k_journal_mode) {
  const int descriptor = descriptor_.get();
  if (descriptor < 0) refuse_output(file, reason());
  if (worldio::lock_file(descriptor) == worldio::FileLock::held)
    throw OutputError(fmt::format(
        "{}: error: another process is running this part of the study: wait until it ends", file.string()));
  const std::vector<std::string> lines = whole_lines(file);
  if (!lines.empty()) check_head(lines.front(), study, facts, file);
  std::size_t whole = 0;
  for (const std::string& line : lines) whole += line.size() + 1;
  if (ftruncate(descriptor, static_cast<off_t>(whole)) != 0) refuse_output(file, reason());
  if (lines.empty() && !worldio::write_all(descriptor, head_of(study, facts) + "\n"))
    refuse_output(file, reason());
  worldio::sync_folder_of(file);
}

void SweepJournal::add(const SweepOutcome& outcome) { append(outcome.run, line_of(outcome)); }

void SweepJournal::add_failure(std::size_t run, const std::string& error) {
  // The error may quote a name that is not UTF-8, which dump() would refuse.
  append(run, Json{{"run", run}, {"error", error}}.dump(-1, ' ', false, Json::error_handler_t::replace));
}

void SweepJournal::append(std::size_t run, std::string line) {
  line += '\n';
  const int descriptor = descriptor_.get();
  const off_t start = lseek(descriptor, 0, SEEK_END);
  if (start >= 0 && worldio::write_all(descriptor, line) && fsync(descriptor) == 0) return;
  const std::string why = reason();
  // A part of the line, for example on a full disk, would be joined with the line of a later call. If it
  // cannot be removed here, the constructor of the next sweep removes it.
  [[maybe_unused]] const bool is_removed = start >= 0 && ftruncate(descriptor, start) == 0;
  throw std::runtime_error(
      fmt::format("{}: error: the result of run {} cannot be written: {}", file_.string(), run, why));
}

SweepResults read_journals(const fs::path& folder, std::string_view study, const SweepSize& size,
                           const StudyFacts& facts) {
  SweepResults results;
  std::error_code error;
  const fs::directory_iterator entries(folder, error);
  if (error)
    throw OutputError(fmt::format("{}: error: cannot be read: {}", folder.string(), error.message()));
  for (const fs::directory_entry& entry : entries) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(k_prefix) || !name.ends_with(k_ending)) continue;
    const std::vector<std::string> lines = whole_lines(entry.path());
    if (lines.empty()) continue;  // the process was killed before it wrote the first line
    check_head(lines.front(), study, facts, entry.path());
    for (std::size_t i = 1; i < lines.size(); ++i)
      if (!read_line(lines[i], size, results))
        throw OutputError(
            fmt::format("{}:{}: error: not a result that troupe sweep writes: the file is damaged; remove "
                        "it, and repeat the command, which makes the missing runs again",
                        entry.path().string(), i + 1));
  }
  for (const auto& [run, outcome] : results.outcomes) results.failed.erase(run);
  return results;
}

fs::path journal_file(const fs::path& folder, std::size_t part, std::size_t parts) {
  return folder / fmt::format("{}{}-of-{}{}", k_prefix, part, parts, k_ending);
}

}  // namespace troupe::apps
