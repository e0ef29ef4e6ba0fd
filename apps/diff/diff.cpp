#include "apps/diff/diff.hpp"

#include "apps/diff/diff_recordings.hpp"
#include "apps/diff/diff_tables.hpp"
#include "apps/hash_log_reader.hpp"
#include "apps/messages.hpp"
#include "apps/options.hpp"
#include "apps/run_header.hpp"
#include "base/diagnostics.hpp"
#include "base/hash.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::apps {
namespace {

constexpr const char* k_diff_footer = R"(
Compares two hash logs (troupe run --hash-log). Prints the first tick at which they differ, and which of the four groups
of the state differ: pose, velocity, sensor and memory. The groups indicate the cause: a difference only in sensor comes
from range finding, one in pose or velocity from the drives or from the resolution of conflicts between motions, and one
in memory from a controller. If one log begins later than the other, earlier ticks are not compared; if one log ends
earlier, the logs differ.

Also compares two recordings (troupe run --record), in the ticks and fields that both recordings have. Prints the first
frame that differs, with the component, the robot, the field, and the values in B and A, in hexadecimal and decimal.

Also compares two tables of results of troupe sweep (table.csv), row by row: prints the rows of the same run that
differ, with the values in A and B, and the rows and columns that only one of the tables has.

Two files of different versions, compilers, flags or instruction sets are compared only with --across-domains, and two
files of different worlds, seeds, options or plug-ins only with --across-runs: the latter also finds the first tick at
which two versions of a controller differ. Numbers of threads and tile sizes may differ, because they change no result.

Exit codes: 0 same bits; 1 different; 2 bad input or usage.

Examples:
  troupe diff one-thread.log eight-threads.log
  troupe diff gcc.log clang.log --across-domains
  troupe diff monday.h5 tuesday.h5
  troupe diff monday/table.csv tuesday/table.csv)";

std::string groups_that_differ(const HashLogReader::Line& a, const HashLogReader::Line& b) {
  std::vector<std::string_view> names;
  for (std::size_t g = 0; g < engine::k_hash_groups; ++g)
    if (a.groups[g] != b.groups[g])
      names.push_back(engine::hash_group_name(static_cast<engine::HashGroup>(g)));
  return comma_list(names);
}

/// Reads lines of a log into `line` until its tick is at least `tick`. `line` becomes empty if the log has no
/// such line.
void skip_to(HashLogReader& log, std::optional<HashLogReader::Line>& line, std::uint64_t tick) {
  while (line && line->tick < tick) line = log.next();
}

ExitCode diff_hash_logs(const DiffOptions& options) {
  HashLogReader first(options.first);
  HashLogReader second(options.second);
  refuse_unlike(first.header(), second.header(), options.across_domains, options.across_runs);

  std::optional<HashLogReader::Line> a = first.next();
  std::optional<HashLogReader::Line> b = second.next();
  for (const auto& [log, line] : {std::pair(&first, &a), std::pair(&second, &b)})
    if (!*line)
      throw InputError(fmt::format(
          "{}: error: the log contains no tick to compare: its run ended before it wrote one; repeat the run",
          log->file().string()));
  const std::uint64_t begin = std::max(a->tick, b->tick);
  skip_to(first, a, begin);
  skip_to(second, b, begin);
  if (!a || !b)
    throw InputError(fmt::format(
        "{}: error: the log ends before tick {}, at which {} begins: the logs have no tick in common",
        (a ? second : first).file().string(), begin, (a ? first : second).file().string()));

  HashLogReader::Line last = *a;
  for (; a && b; a = first.next(), b = second.next()) {
    last = *a;
    if (a->groups == b->groups) continue;
    print("differs at tick {}, in {}:\n  {}:{}: {}\n  {}:{}: {}\n", a->tick, groups_that_differ(*a, *b),
          options.first.string(), a->number, a->text, options.second.string(), b->number, b->text);
    return k_failed;
  }
  if (a || b) {
    fmt::print("differs in length: {} ends at tick {}, but {} continues; same bits from tick {} until then\n",
               (a ? second : first).file().string(), last.tick, (a ? first : second).file().string(), begin);
    return k_failed;
  }
  fmt::print("same bits, tick {} to {}; the last state has the hash {}\n", begin, last.tick, hex(last.state));
  return k_finished;
}

}  // namespace

void add_diff_options(CLI::App& command, DiffOptions& options) {
  command.footer(k_diff_footer);
  add_argument(command, "A", "A hash log, a recording or a table of a sweep", options.first);
  add_argument(command, "B", "Another file of the same type as A", options.second);
  add_switch(command, "--across-domains", options.across_domains,
             "Compare even if version, compiler, flags or instruction set differ");
  add_switch(command, "--across-runs", options.across_runs,
             "Compare even if world, seed, options or plug-ins differ");
}

ExitCode diff(const DiffOptions& options) {
  if (is_results_table(options.first) || is_results_table(options.second)) return diff_tables(options);
  const bool recordings = is_hdf5(options.first) || is_hdf5(options.second);
  return recordings ? diff_recordings(options) : diff_hash_logs(options);
}

}  // namespace troupe::apps
