#include "apps/hash_log_reader.hpp"

#include "base/diagnostics.hpp"
#include "base/number_text.hpp"
#include "base/split.hpp"
#include "troupe/effective_options.hpp"
#include "worldio/files.hpp"

#include <fmt/format.h>

#include <charconv>
#include <numeric>
#include <utility>
#include <vector>

namespace troupe::apps {
namespace {

constexpr std::string_view k_form =
    "TICK STATE pose=HASH velocity=HASH sensor=HASH memory=HASH, with 16 lower-case hexadecimal digits for "
    "STATE and each HASH";
constexpr std::size_t k_shown = 120;  // largest number of bytes of a line that an error quotes

/// Reads a hash. Returns nothing if the text is not exactly 16 lower-case hexadecimal digits.
std::optional<std::uint64_t> hash_of(std::string_view text) {
  if (text.size() != 16 || text.find_first_not_of("0123456789abcdef") != text.npos) return std::nullopt;
  std::uint64_t hash = 0;
  std::from_chars(text.data(), text.data() + text.size(), hash, 16);
  return hash;
}

}  // namespace

HashLogReader::HashLogReader(const std::filesystem::path& file) : header_{.file = file} {
  if (const Result<> readable = worldio::check_readable(file); !readable)
    throw InputError(fmt::format("{}: error: {}", file.string(), readable.error().text));
  stream_.open(file, std::ios::binary);
  if (!stream_) throw InputError(fmt::format("{}: error: cannot be read", file.string()));
  // The mark is read without read_line(), which could need as much memory as the file is long: another file
  // may have no line break at all.
  std::string line(k_hash_log_mark.size(), '\0');
  stream_.read(line.data(), static_cast<std::streamsize>(line.size()));
  if (line != k_hash_log_mark || !read_line(line) || !line.empty())
    throw InputError(
        fmt::format("{}:1: error: not a hash log (troupe run --hash-log): the first line must be \"{}\"",
                    file.string(), k_hash_log_mark));
  while (read_line(line)) {
    if (!line.starts_with('#')) {
      ahead_ = std::move(line);
      return;
    }
    read_header(line);
  }
}

std::optional<HashLogReader::Line> HashLogReader::next() {
  std::string text;
  if (ahead_) {
    text = std::move(*ahead_);
    ahead_.reset();
  } else if (!read_line(text)) {
    return std::nullopt;
  }
  Line line = parse(text);
  if (last_tick_ && line.tick != *last_tick_ + 1)
    fail(fmt::format("tick {} follows tick {}: the log is damaged, because lines are missing or repeated",
                     line.tick, *last_tick_));
  last_tick_ = line.tick;
  return line;
}

bool HashLogReader::read_line(std::string& line) {
  if (!std::getline(stream_, line)) {
    if (stream_.bad()) fail("the file cannot be read beyond this line");
    return false;
  }
  ++number_;
  if (stream_.eof())
    fail("the last line is incomplete: the log was cut off; remove this line to compare the other lines");
  if (line.ends_with('\r')) line.pop_back();  // editors may write CR LF
  return true;
}

void HashLogReader::read_header(const std::string& line) {
  const auto colon = line.find(": ");
  if (!line.starts_with("# ") || colon == line.npos)
    fail(fmt::format("\"{}\" is not a header line; expected # KEY: VALUE", line.substr(0, k_shown)));
  const std::string key = from_one_line(line.substr(2, colon - 2));
  if (!header_.entries.emplace(key, RunHeader::Entry{from_one_line(line.substr(colon + 2)), number_}).second)
    fail(fmt::format("the header \"{}\" occurs twice", key));
}

HashLogReader::Line HashLogReader::parse(const std::string& text) const {
  Line line{.number = number_, .text = text};
  const auto malformed = [&] {
    fail(fmt::format("\"{}\" is not a line of a hash log; expected {}", text.substr(0, k_shown), k_form));
  };
  const std::vector<std::string_view> words = split(text, ' ');
  if (words.size() != 2 + engine::k_hash_groups) malformed();
  const auto tick = number_of<std::uint64_t>(words[0]);
  const auto state = hash_of(words[1]);
  if (!tick || !state) malformed();
  line.tick = *tick;
  line.state = *state;
  for (std::size_t g = 0; g < engine::k_hash_groups; ++g) {
    const std::string_view name = engine::hash_group_name(static_cast<engine::HashGroup>(g));
    const std::string_view word = words[2 + g];
    if (!word.starts_with(name) || word.substr(name.size(), 1) != "=") malformed();
    const auto hash = hash_of(word.substr(name.size() + 1));
    if (!hash) malformed();
    line.groups[g] = *hash;
  }
  if (std::accumulate(line.groups.begin(), line.groups.end(), std::uint64_t{0}) != line.state)
    fail("the state hash is not the sum of the group hashes: the line is damaged");
  return line;
}

void HashLogReader::fail(const std::string& message) const {
  throw InputError(fmt::format("{}:{}: error: {}", file().string(), number_, message));
}

}  // namespace troupe::apps
