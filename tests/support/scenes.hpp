#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Reads the manifest of the worlds that come with Troupe, worlds/scenes.json, for tests and benchmarks. The
/// manifest is a list of worlds with the tests and benchmarks that use each world; docs/worlds.md describes
/// its keys. This code checks the values of the keys `tests` and `perf`; scripts/proofs/scenes.py checks
/// those of all other keys.
namespace troupe::scenes {

/// A run of a world in a test suite, as listed in the manifest. The manifest may set only some of the
/// members; which ones depends on the suite. The others keep their defaults.
struct Run {
  std::string world;                       ///< file name in worlds/
  bool by_grid = false;                    ///< use the grid engine instead of the world's engine
  std::optional<std::size_t> robots;       ///< size of the only population; not set: as in the world file
  std::optional<std::size_t> robots_slow;  ///< size in slow builds (test::k_slow_build)
  std::uint64_t warm_ticks = 0;            ///< ticks before the tested ticks
  std::uint64_t ticks = 0;                 ///< tested ticks
  unsigned threads = 1;

  std::filesystem::path file() const;  ///< path of the world file
  /// Returns a name for the run, such as `crowdByGrid`, with letters, digits and underscores only. The runs
  /// of a suite must have different names.
  std::string name() const;
  friend std::ostream& operator<<(std::ostream& out, const Run& run) { return out << run.name(); }
};

/// A variant of the world of a benchmark: the same world with some other values. In each repetition of the
/// benchmark, the world and all its variants are timed, one after another.
struct Variant {
  std::string name;  ///< name of the variant in the report
  std::vector<std::pair<std::string, std::string>>
      set;  ///< the other values: JSON pointers and values, as for the option --set of `troupe run`
};

/// A world that the benchmark program perf_paper measures with several numbers of robots. The report has one
/// table row for each number.
struct Benchmark {
  std::string world;                     ///< file name in worlds/
  std::string table;                     ///< id of the table in the report
  std::vector<std::size_t> robots;       ///< numbers of robots
  std::vector<std::size_t> quick;        ///< numbers of robots if perf_paper runs with --quick
  std::vector<std::string> populations;  ///< populations that share the robots equally; empty: the only one
  std::optional<double> for_s;           ///< simulated time, s; not set: the default of the table
  std::vector<Variant> beside;           ///< variants that are timed together with the world
  /// Used only for the table of memory use. True: the table also has rows for the world loaded from .world
  /// text (Stage's syntax), and for the world without robots.
  bool as_text = false;
};

/// The content of a manifest that tests and benchmarks use.
struct Manifest {
  std::map<std::string, std::vector<Run>, std::less<>> tests;  ///< the runs of each suite, by its name
  std::vector<Benchmark> perf;                                 ///< in the order of the manifest
};

/// Reads and checks a manifest. Throws std::runtime_error with the first error: an unknown key, a value of
/// the wrong type, an unknown test suite, or a world file that is not in the folder of the manifest.
Manifest read_manifest(const std::filesystem::path& file);

/// Returns the runs that worlds/scenes.json lists for a test suite. If the manifest has an error or does not
/// name the suite, prints an error and ends the program with exit code 2. The function throws no exception,
/// because test programs call it before their tests begin.
std::vector<Run> runs_of(std::string_view suite);

}  // namespace troupe::scenes
