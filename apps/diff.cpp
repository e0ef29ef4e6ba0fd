#include "apps/diff.hpp"

#include "apps/hash_log_reader.hpp"
#include "base/diagnostics.hpp"
#include "base/hash.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::apps {
namespace {

constexpr const char* k_footer = R"(
Takes two hash logs (troupe run --hash-log) and names the first tick at which they differ, with the groups of the state
in which it shows: sensor alone at first means ranging; pose or velocity the drives or the conflict rule; memory a
controller. Where one begins later, the ticks before are left out; where one ends earlier, they differ.

Logs of another version, compiler, flags or instruction set are refused unless --across-domains is given, those of
another world, seed or option unless --across-runs is. Threads and tile size change no result, and are not looked at.

Exit codes: 0 same bits; 1 they differ; 2 bad input or usage.

Examples:
  troupe diff one-thread.log eight-threads.log
  troupe diff gcc.log clang.log --across-domains)";

/// A part of the version line that bits may depend on.
struct DomainPart {
  std::string_view name;
  std::string value;
};

/// The parts of `troupe 0.1.0 (GNU 12.2.0; Release -O3; x86_64; assertions off)`; assertions only look on.
/// The whole where it reads otherwise.
std::vector<DomainPart> domain_of(const std::string& version_line) {
  constexpr std::array<std::string_view, 3> k_names = {"compiler", "flags", "instruction set"};
  std::vector<DomainPart> parts;
  std::size_t start = version_line.find(" (");
  if (start == version_line.npos) return {{"version", version_line}};
  parts.push_back({"version", version_line.substr(0, start)});
  start += 2;
  for (const std::string_view name : k_names) {
    const std::size_t end = version_line.find("; ", start);
    if (end == version_line.npos) return {{"version", version_line}};
    parts.push_back({name, version_line.substr(start, end - start)});
    start = end + 2;
  }
  return parts;
}

/// What two logs do not have in common, as errors that stand where the second says it.
class Unlike {
 public:
  Unlike(const HashLogReader& first, const HashLogReader& second) : first_(first), second_(second) {}

  void compare_domains() {
    const std::vector<DomainPart> a = domain_of(value(first_, "version"));
    const std::vector<DomainPart> b = domain_of(value(second_, "version"));
    if (a.size() != b.size()) {
      note("version", "version", value(first_, "version"), value(second_, "version"), k_domain);
      return;
    }
    for (std::size_t i = 0; i < a.size(); ++i) note("version", a[i].name, a[i].value, b[i].value, k_domain);
  }

  void compare_runs() {
    std::set<std::string> keys;
    for (const HashLogReader* log : {&first_, &second_})
      for (const auto& [key, header] : log->headers()) keys.insert(key);
    for (const char* free : {"version", "threads", "tile_m", "resumed_at_tick"}) keys.erase(free);
    for (const std::string& key : keys) {
      std::string a = value(first_, key);
      std::string b = value(second_, key);
      if (key == "world") {  // wherever it was read from
        a = std::filesystem::path(a).filename().string();
        b = std::filesystem::path(b).filename().string();
      }
      note(key, key, a, b, k_run);
    }
  }

  void throw_if_any() const {
    if (!text_.empty()) throw InputError(text_);
  }

 private:
  static constexpr const char* k_domain = "another determinism domain; --across-domains";
  static constexpr const char* k_run = "another run; --across-runs";

  static std::string value(const HashLogReader& log, const std::string& key) {
    const auto header = log.headers().find(key);
    return header == log.headers().end() ? "" : header->second.value;
  }

  void note(const std::string& key, std::string_view what, const std::string& a, const std::string& b,
            const char* reason) {
    if (a == b) return;
    const auto header = second_.headers().find(key);
    const std::size_t line = header == second_.headers().end() ? 1 : header->second.line;
    if (!text_.empty()) text_ += '\n';
    text_ += fmt::format("{}:{}: error: {} is \"{}\", in {} \"{}\": {} compares them all the same",
                         second_.file().string(), line, what, b, first_.file().string(), a, reason);
  }

  const HashLogReader& first_;
  const HashLogReader& second_;
  std::string text_;
};

std::string groups_that_differ(const HashLogReader::Line& a, const HashLogReader::Line& b) {
  std::vector<std::string_view> names;
  for (std::size_t g = 0; g < engine::k_hash_groups; ++g)
    if (a.groups[g] != b.groups[g])
      names.push_back(engine::hash_group_name(static_cast<engine::HashGroup>(g)));
  return comma_list(names);
}

/// The first tick of a log, or of its part that the other has too.
void skip_to(HashLogReader& log, std::optional<HashLogReader::Line>& line, std::uint64_t tick) {
  while (line && line->tick < tick) line = log.next();
}

ExitCode diff_hash_logs(const DiffOptions& options) {
  HashLogReader first(options.first);
  HashLogReader second(options.second);
  Unlike unlike(first, second);
  if (!options.across_domains) unlike.compare_domains();
  if (!options.across_runs) unlike.compare_runs();
  unlike.throw_if_any();

  std::optional<HashLogReader::Line> a = first.next();
  std::optional<HashLogReader::Line> b = second.next();
  for (const auto& [log, line] : {std::pair(&first, &a), std::pair(&second, &b)})
    if (!*line) throw InputError(fmt::format("{}: error: the log has no tick", log->file().string()));
  const std::uint64_t begin = std::max(a->tick, b->tick);
  skip_to(first, a, begin);
  skip_to(second, b, begin);
  if (!a || !b)
    throw InputError(fmt::format("{}: error: the log ends before tick {}, at which {} begins",
                                 (a ? second : first).file().string(), begin,
                                 (a ? first : second).file().string()));

  HashLogReader::Line last = *a;
  for (; a && b; a = first.next(), b = second.next()) {
    last = *a;
    if (a->groups == b->groups) continue;
    fmt::print("differs at tick {}, in {}:\n  {}:{}: {}\n  {}:{}: {}\n", a->tick, groups_that_differ(*a, *b),
               options.first.string(), a->number, a->text, options.second.string(), b->number, b->text);
    return k_failed;
  }
  if (a || b) {
    fmt::print("differs in length: {} ends at tick {}, {} goes on; the same bits from tick {} until then\n",
               (a ? second : first).file().string(), last.tick, (a ? first : second).file().string(), begin);
    return k_failed;
  }
  fmt::print("same bits, tick {} to {}; the last state is {}\n", begin, last.tick, hex(last.state));
  return k_finished;
}

}  // namespace

CLI::App* add_diff_command(CLI::App& app, DiffOptions& options) {
  CLI::App* command = app.add_subcommand("diff", "Find the first tick at which two hash logs differ");
  command->footer(k_footer);
  const auto add_file = [command](const char* name, std::filesystem::path& file, const char* help) {
    command
        ->add_option_function<std::string>(
            name, [&file](const std::string& text) { file = text; }, help)
        ->option_text(" ")
        ->required();
  };
  add_file("A", options.first, "A hash log");
  add_file("B", options.second, "Another");
  const auto add_switch = [command](const char* name, bool& on, const char* help) {
    command->add_flag(name, on, help)->disable_flag_override();
  };
  add_switch("--across-domains", options.across_domains,
             "Though version, compiler, flags or processor differ");
  add_switch("--across-runs", options.across_runs, "Though world, seed or options differ");
  return command;
}

ExitCode diff(const DiffOptions& options) {
  try {
    const ExitCode code = diff_hash_logs(options);
    if (std::fflush(stdout) != 0) throw std::runtime_error("standard output cannot be written");
    return code;
  } catch (const InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return k_bad_input;
  }
}

}  // namespace troupe::apps
