// Reproduces the tables of the paper on Stage (Vaughan, Massively multi-robot simulation in Stage, 2008), and
// also measures clusters, a million robots, threads, loading and memory. Each row of a table checks the
// result as well: the hash of its final state is compared with a recorded one, and a wrong hash fails the
// run.
//   build/release/bin/perf_paper --help

#include "base/diagnostics.hpp"
#include "partition/processors.hpp"
#include "partition/simd_target.hpp"
#include "tests/support/paths.hpp"
#include "troupe/registry.hpp"
#include "worldio/results/hdf5_file.hpp"
#include "perf/paper_cases.hpp"
#include "perf/paper_children.hpp"
#include "perf/paper_hashes.hpp"
#include "perf/paper_report.hpp"
#include "perf/paper_timing.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <optional>
#include <regex>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace troupe::perf {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_footer = R"(
A full run of five repetitions takes about an hour and 2 GB of memory on a computer of 2023 with two cores.
A run with --quick takes a few seconds. Run nothing else on the machine meanwhile: other load increases the
difference between the columns min and max.

--list prints the names of the rows of all tables. For example, --only '^3/' measures only table 3, and --only 'loading'
only the loading of worlds.

Exit codes: 0: all selected rows were measured; 1: a hash is wrong or unknown, or a measurement failed;
2: wrong usage.)";

struct Options {
  bool quick = false;
  bool list = false;
  bool write_hashes = false;
  std::size_t repeat = 0;  // 0: not given
  std::string only;
  std::vector<unsigned> threads;
  std::vector<std::string> simd;  // the first is for most rows; the comparison of instruction sets uses all
  fs::path out;
  fs::path markdown;
  fs::path hashes = test::source_dir() / "perf/paper_hashes.txt";
  std::optional<std::size_t> child;
  fs::path child_world;
};

std::string row_name(const Case& one) { return one.table + "/" + one.runs.front().scene.name; }
std::string row_name(const Child& child) {
  return "loading/" + child.scene.name + (child.as_text ? "/text" : "");
}

/// Prints the row that is being measured, if standard error is a terminal.
class Progress {
 public:
  ~Progress() { wipe(); }
  void operator()(const std::string& text) {
    if (!visible_) return;
    wipe();
    fmt::print(stderr, "{}", text);
    std::fflush(stderr);
  }
  /// Prints a line that is not overwritten.
  void keep(const std::string& text) {
    wipe();
    fmt::print(stderr, "{}\n", text);
  }

 private:
  void wipe() const {
    if (visible_) fmt::print(stderr, "\r\x1b[K");
  }
  bool visible_ = isatty(STDERR_FILENO) != 0;
};

/// Returns an error if a run is not possible here, because its world file is missing or because this build
/// cannot draw pictures or write recordings. draws: the result of can_draw().
Result<> can_run(const Run& run, const Result<>& draws) {
  if (const Result<> found = has_world(run.scene); !found)
    return Error{fmt::format("{}: {}", run.scene.name, found.error().text)};
  if (run.frames && !draws) return Error{"frames: " + draws.error().text};
  if (run.watch == Watch::recording && !worldio::has_hdf5())
    return Error{"recording: this build has no HDF5"};
  return {};
}

/// Removes from the plan the rows that the regular expression `only` does not select and the rows that cannot
/// run here. If a row about loading is kept, the row of the world without robots is kept too, because the
/// memory of the other rows is compared with the memory of this row. Adds the reasons why rows cannot run to
/// `skipped`.
void reduce(Plan& plan, const std::string& only, std::vector<std::string>& skipped) {
  const std::regex wanted(only);
  std::erase_if(plan.cases, [&](const Case& one) { return !std::regex_search(row_name(one), wanted); });
  const bool loads = std::ranges::any_of(
      plan.children, [&](const Child& child) { return std::regex_search(row_name(child), wanted); });
  std::erase_if(plan.children, [&](const Child& child) {
    return !(child.empty && loads) && !std::regex_search(row_name(child), wanted);
  });
  const Result<> draws = can_draw();
  std::set<std::string> reasons;
  for (Case& one : plan.cases)
    std::erase_if(one.runs, [&](const Run& run) {
      const Result<> can = can_run(run, draws);
      if (can) return false;
      if (reasons.insert(can.error().text).second) skipped.push_back(can.error().text);
      return true;
    });
  std::erase_if(plan.cases, [](const Case& one) { return one.runs.empty(); });
}

/// Keeps one run per scene and length of simulation, and sets its number of threads. That is enough to record
/// hashes.
void keep_one_run(Plan& plan, unsigned threads) {
  std::set<std::string> seen;
  for (Case& one : plan.cases) {
    std::erase_if(one.runs, [&](const Run& run) {
      return !seen.insert(fmt::format("{} {} {}", run.scene.name, run.scene.skip_s, run.scene.for_s)).second;
    });
    for (Run& run : one.runs) run.threads = threads;
  }
  std::erase_if(plan.cases, [](const Case& one) { return one.runs.empty(); });
}

/// A temporary folder, which the destructor removes.
class Scratch {
 public:
  Scratch() : folder_(fs::temp_directory_path() / fmt::format("perf_paper.{}", getpid())) {
    fs::create_directories(folder_);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  fs::path file(const char* name) const { return folder_ / name; }

 private:
  fs::path folder_;
};

std::vector<ChildTiming> time_children(const Plan& plan, const Plan& whole, const Options& options,
                                       const engine::Registry& registry, Progress& progress) {
  std::vector<ChildTiming> out;
  const Scratch scratch;
  for (const Child& child : plan.children) {
    progress(row_name(child));
    const auto index = std::ranges::find_if(
        whole.children, [&](const Child& other) { return row_name(other) == row_name(child); });
    std::vector<std::string> arguments{"--child", fmt::format("{}", index - whole.children.begin())};
    if (options.quick) arguments.emplace_back("--quick");
    arguments.insert(arguments.end(), {"--simd", options.simd.front()});
    if (child.as_text) {
      const fs::path world = scratch.file("robots.world");
      write_as_text(child.scene, world, registry);
      arguments.insert(arguments.end(), {"--child-world", world.string()});
    }
    out.push_back(time_child(child, arguments, options.repeat));
    const ChildReport& report = out.back().reports.front();
    progress.keep(fmt::format("{}: {} robots, loaded in {:.3f} s, {:.1f} MB", row_name(child), report.robots,
                              report.read_s + report.build_s, report.rss_bytes / 1e6));
  }
  return out;
}

void write_file(const fs::path& file, const std::string& text) {
  std::ofstream stream(file);
  stream << text << std::flush;
  if (!stream) throw std::runtime_error(fmt::format("{}: error: cannot be written", file.string()));
}

/// Returns an error text if the folder of a file does not exist, otherwise an empty text. Without this check
/// of the options, the error would end the program after an hour, when it writes the file.
std::string find_folder(const std::string& file) {
  const fs::path folder = fs::absolute(file).parent_path();
  return fs::is_directory(folder) ? "" : fmt::format("{}: there is no folder {}", file, folder.string());
}

/// Makes the kernels (vectorised loops) use the instruction set `name`. Returns the error text if this is not
/// possible, otherwise an empty text. (CLI11 expects such a function as the check of an option.)
std::string select_simd(const std::string& name) {
  try {
    partition::use_simd_target(name);
    return {};
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

int measure(Options& options) {
  if (options.repeat == 0) options.repeat = options.quick || options.write_hashes ? 1 : 5;
  if (options.threads.empty()) {
    options.threads = {1};
    if (const unsigned cores = partition::processors_allowed(); cores > 1) options.threads.push_back(cores);
  }
  if (options.simd.empty()) options.simd = partition::simd_targets().usable;
  partition::use_simd_target(options.simd.front());
  const engine::Registry registry = make_registry();
  const Plan whole = make_plan(options.quick, options.threads, options.simd);
  if (options.child) {
    Scene scene = whole.children.at(*options.child).scene;
    if (!options.child_world.empty()) {
      scene.world = options.child_world;
      scene.load = {};
    }
    report_child(scene, registry);
    return 0;
  }
  Plan plan = whole;
  Report report{.machine = describe_machine(),
                .repeat = options.repeat,
                .quick = options.quick,
                .tables = plan.tables,
                .cases = {},
                .children = {},
                .skipped = {}};
  reduce(plan, options.only, report.skipped);
  for (const std::string& reason : report.skipped) fmt::print(stderr, "SKIPPED {}\n", reason);
  if (options.list) {
    for (const Case& one : plan.cases) fmt::print("{}\n", row_name(one));
    for (const Child& child : plan.children) fmt::print("{}\n", row_name(child));
    return 0;
  }
  if (plan.cases.empty() && plan.children.empty())
    throw std::runtime_error(
        fmt::format("no row has a name that matches \"{}\"; --list prints the names", options.only));

  if (options.write_hashes) keep_one_run(plan, std::ranges::max(options.threads));

  HashBook book(options.hashes);
  Progress progress;
  // Child processes come first: they are forked while this process is small.
  report.children = time_children(plan, whole, options, registry, progress);
  for (const Case& one : plan.cases) {
    report.cases.push_back(
        time_case(one, options.repeat, registry, [&](const std::string& text) { progress(text); }));
    for (const Timing& t : report.cases.back().timings)
      progress.keep(fmt::format("{}/{}, {} thread{}{}: {:.0f} ns, {:.4g} x real time", one.table,
                                t.run.scene.name, t.run.threads, t.run.threads > 1 ? "s" : "",
                                with_text(t.run), t.ns(median(t.wall_s)),
                                t.times_real_time(median(t.wall_s))));
  }

  const std::vector<Sheet> tables =
      sheets(report, read_reference(test::source_dir() / "perf/paper_reference.json"));
  for (const auto& [key, value] : report.machine) fmt::print("{:<20} {}\n", key, value);
  for (const Sheet& sheet : tables) fmt::print("{}", plain_text(sheet));
  std::fflush(stdout);
  if (!options.out.empty()) write_file(options.out, json(report));
  if (!options.markdown.empty()) write_between_marks(options.markdown, markdown(report, tables));

  const std::vector<std::string> faults = check_hashes(report, book, options.write_hashes);
  for (const std::string& error : faults) fmt::print(stderr, "{}\n", error);
  if (options.write_hashes && faults.empty()) book.save();
  return faults.empty() ? 0 : 1;
}

int paper_main(int argc, char** argv) {
  CLI::App app(
      "Measures the speed of Troupe in the runs of the tables in the paper on Stage (Vaughan, Massively "
      "multi-robot simulation in Stage, 2008), and in further runs.",
      "perf_paper");
  app.footer(k_footer);
  Options options;
  app.add_flag("--quick", options.quick,
               "Use few robots and short times, only to test that the rows run and that their hashes are "
               "correct");
  app.add_option("--repeat", options.repeat,
                 "Repetitions of each row (default: 5; 1 with --quick and --write-hashes)")
      ->check(CLI::Range(1, 1000));
  app.add_option("--only", options.only, "Measure only rows whose name matches this regular expression");
  app.add_flag("--list", options.list, "Print the names of the rows and measure nothing");
  app.add_option("--threads", options.threads,
                 "Numbers of threads, as in 1,2,4. Most rows are measured with each of these numbers; some, "
                 "such as rows with pictures, only with the first (default: 1, and one thread per core)")
      ->delimiter(',')
      ->check(CLI::Range(1, 1024));
  app.add_option(
         "--simd", options.simd,
         "Instruction sets, as in avx2,sse4. The comparison of instruction sets uses all of them, all other "
         "rows only the first (default: all that this processor has, the best first)")
      ->delimiter(',')
      ->check(select_simd, "");
  app.add_option("--out", options.out, "Write all measurements to this file, as JSON")
      ->check(find_folder, "");
  app.add_option(
         "--markdown", options.markdown,
         "Write the tables to this file, as Markdown. They replace the text between its lines "
         "`<!-- perf_paper: begin -->` and `<!-- perf_paper: end -->`, or the whole file if it has no such "
         "lines")
      ->check(find_folder, "");
  app.add_flag("--write-hashes", options.write_hashes,
               "Record the hashes in the file of --hashes instead of checking them; each scene runs once");
  app.add_option("--hashes", options.hashes, "File with the expected hashes of the rows")
      ->capture_default_str();
  app.add_option("--child", options.child)->group("");
  app.add_option("--child-world", options.child_world)->group("");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return measure(options);
}

}  // namespace
}  // namespace troupe::perf

int main(int argc, char** argv) {
  try {
    return troupe::perf::paper_main(argc, argv);
  } catch (const std::regex_error& error) {
    fmt::print(stderr, "perf_paper: error: --only is not a regular expression: {}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "perf_paper: error: {}\n", error.what());
    return 1;
  }
}
