#include "apps/info/info.hpp"

#include "apps/hash_log_reader.hpp"
#include "apps/info/info_kinds.hpp"
#include "apps/messages.hpp"
#include "apps/observers/profile.hpp"
#include "apps/observers/tables.hpp"
#include "apps/options.hpp"
#include "apps/sweep/journal.hpp"
#include "apps/sweep/table.hpp"
#include "base/diagnostics.hpp"
#include "troupe/registry.hpp"
#include "worldio/characters.hpp"
#include "worldio/files.hpp"
#include "worldio/results/checkpoint.hpp"
#include "worldio/results/hdf5_superblock.hpp"
#include "worldio/stage/stage_properties.hpp"
#include "worldio/wrong_file.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

constexpr const char* k_info_footer = R"(
Accepts a world (Stage's or JSON), a hash log, a recording, a checkpoint, a table of measures or events, a profile, a
study, a table or journal that troupe sweep wrote, or a session of troupe view. The type is detected from the content;
the file name matters only for an empty world.

Prints the type, the program that wrote the file, its world, seed, robots, ticks and fields, and whether the file is
complete or was cut off, for example by a full disk or because the run was killed.

Exit codes: 0 printed; 2 the file has none of these types, has errors, or cannot be read.

Examples:
  troupe info worlds/hospital.json
  troupe info run.log)";

constexpr std::size_t k_start_bytes = 4096;
constexpr std::size_t k_header_bytes = 1 << 20;  // for the column names of a table with many parameters
constexpr std::string_view k_byte_order_mark = "\xef\xbb\xbf";  // of UTF-8; some editors write it
constexpr std::string_view k_blanks = " \t\r\n";

/// Throws InputError with the reason that errno gives.
[[noreturn]] void throw_unreadable(const fs::path& file) {
  const std::string reason = errno == 0 ? "unknown reason" : std::generic_category().message(errno);
  throw InputError(fmt::format("{}: error: cannot be read: {}", file.string(), reason));
}

/// Returns the first bytes of a file, at most k_header_bytes. Throws InputError if it cannot be read.
std::string first_bytes_of(const fs::path& file) {
  if (const Result<> readable = worldio::check_readable(file); !readable)
    throw InputError(fmt::format("{}: error: {}", file.string(), readable.error().text));
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::string start(k_header_bytes, '\0');
  stream.read(start.data(), k_header_bytes);
  start.resize(static_cast<std::size_t>(stream.gcount()));
  if (!stream.eof() && !stream) throw_unreadable(file);
  return start;
}

/// Returns the content of a file. Throws InputError if the file cannot be read or is too large.
std::string all_of(const fs::path& file) {
  if (const Result<> readable = worldio::check_readable(file, worldio::k_most_input_bytes); !readable)
    throw InputError(fmt::format("{}: error: {}", file.string(), readable.error().text));
  errno = 0;
  std::optional<std::string> text = worldio::read_file(file);
  if (!text) throw_unreadable(file);
  return std::move(*text);
}

/// Returns the first word of a text in the syntax of Stage worlds, skipping comments; empty if the text
/// begins with no word.
std::string first_word(std::string_view text) {
  constexpr std::string_view k_letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_";
  for (;;) {
    text.remove_prefix(std::min(text.find_first_not_of(k_blanks), text.size()));
    if (!text.starts_with('#')) return std::string(text.substr(0, text.find_first_not_of(k_letters)));
    text.remove_prefix(std::min(text.find_first_of("\r\n"), text.size()));
  }
}

/// Whether the first word of a file, whose first bytes are `start`, is a keyword, a model or a property of a
/// Stage world.
bool begins_like_a_stage_world(const fs::path& file, std::string_view start) {
  if (start.find('\0') != start.npos) return false;
  std::string word = first_word(start);
  if (word.empty() && start.starts_with('#')) word = first_word(all_of(file));  // a long comment
  if (word == "include" || word == "define" || word == "window") return true;
  if (make_registry().model(word)) return true;
  return std::ranges::any_of(worldio::stage_rows(), [&](const worldio::StageRow& row) {
    return row.type == "world" && row.name == word;
  });
}

std::optional<Summary> summary_of(const InfoOptions& options) {
  const fs::path& file = options.file;
  const std::string bytes = first_bytes_of(file);
  std::string_view header = bytes;
  if (header.starts_with(k_byte_order_mark)) header.remove_prefix(k_byte_order_mark.size());
  const std::string_view start = header.substr(0, k_start_bytes);
  if (start.starts_with(k_hash_log_mark)) return summary_of_hash_log(file);
  if (start.starts_with(worldio::k_hdf5_signature)) return summary_of_hdf5(file);
  if (worldio::is_checkpoint(file)) return summary_of_checkpoint(file);
  if (start.starts_with(k_events_mark)) return summary_of_events(file);
  if (start.starts_with(k_measures_mark)) return summary_of_measures(file);
  constexpr std::string_view k_profile_line = k_profile_mark.substr(0, k_profile_mark.find('\n'));
  if (start.starts_with(k_profile_line)) return summary_of_profile(file);
  // First: the name of a parameter, such as time_step, may begin like the column time_s of the series.
  if (is_start_of_results(header)) return summary_of_results(file);
  if (start.starts_with(k_series_mark)) return summary_of_series(file);
  if (start.starts_with(k_journal_mark)) return summary_of_journal(file);
  if (file.extension() == ".json" && worldio::is_utf16(start))
    throw InputError(fmt::format("{}: error: {}", file.string(), worldio::k_is_utf16));
  const std::size_t first = start.find_first_not_of(k_blanks);
  if (first != start.npos && start[first] == '{') {
    if (start.substr(0, start.find('\n')).find("\"troupe_session\"") != start.npos)
      return summary_of_session(file);
    return summary_of_json(file, all_of(file), options.sources);
  }
  if (const auto wrong = worldio::wrong_file_text(bytes); wrong && first != start.npos)
    throw InputError(fmt::format("{}: error: {}", file.string(), *wrong));
  // The ending counts for an empty world, and for one whose start is an error, which the reader reports.
  if (file.extension() == ".world" || begins_like_a_stage_world(file, start))
    return summary_of_world(file, all_of(file), false, options.sources);
  return std::nullopt;
}

}  // namespace

void add_info_options(CLI::App& command, InfoOptions& options) {
  command.footer(k_info_footer);
  add_argument(command, "FILE", "World, result or other file of Troupe", options.file);
  add_kind_options(command, options.sources);
}

ExitCode info(const InfoOptions& options) {
  const fs::path& file = options.file;
  const std::optional<Summary> summary = summary_of(options);
  if (!summary)
    throw InputError(fmt::format(
        "{}: error: not a file that this command knows: expected a world (Stage's or JSON), "
        "a hash log, a recording, a checkpoint, a table of measures or events, a profile, a study, "
        "a table or journal that troupe sweep wrote, or a session of troupe view",
        file.string()));
  print("{}\n", file.string());
  for (const auto& [name, value] : *summary) print("  {:<18} {}\n", name, value);
  return k_finished;
}

}  // namespace troupe::apps
