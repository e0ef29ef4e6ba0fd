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

/// The manifest of the shipped worlds, worlds/scenes.json, for tests and benchmarks. The keys of a row are
/// described in docs/worlds.md. scripts/proofs/scenes.py reads the same file for the scripts, and checks all
/// keys except `tests` and `perf`.
namespace troupe::scenes {

/// A run of a shipped world in a test suite. Each suite defines which of these keys its runs may have; the
/// other members keep their defaults.
struct Run {
  std::string world;                       ///< file name in worlds/
  bool by_grid = false;                    ///< use the grid engine instead of the world's engine
  std::optional<std::size_t> robots;       ///< size of the only population; not set: that of the world
  std::optional<std::size_t> robots_slow;  ///< size in slow builds (k_slow_build)
  std::uint64_t warm_ticks = 0;            ///< ticks before the tested ticks
  std::uint64_t ticks = 0;                 ///< tested ticks
  unsigned threads = 1;

  std::filesystem::path file() const;  ///< path of the world file
  /// Returns a name that is unique in the suite, with letters, digits and underscores only: `crowdByGrid`.
  std::string name() const;
  friend std::ostream& operator<<(std::ostream& out, const Run& run) { return out << run.name(); }
};

/// A variant of the world of a benchmark. The runs of the world and of its variants are timed in turn.
struct Variant {
  std::string name;
  std::vector<std::pair<std::string, std::string>>
      set;  ///< JSON pointers and values, as for the option --set
};

/// Rows of a table of perf_paper: a world with different numbers of robots, one row per number.
struct Benchmark {
  std::string world;  ///< file name in worlds/
  std::string table;  ///< id of the table
  std::vector<std::size_t> robots;
  std::vector<std::size_t> quick;        ///< numbers of robots with --quick
  std::vector<std::string> populations;  ///< among which the robots are divided equally; empty: the only one
  std::optional<double> for_s;           ///< simulated time, s; not set: that of the table
  std::vector<Variant> beside;           ///< variants that are timed together with the world
  bool as_text = false;  ///< table of memory: also measure loading as .world text, and without robots
};

/// The content of a manifest.
struct Manifest {
  std::map<std::string, std::vector<Run>, std::less<>> tests;  ///< by suite
  std::vector<Benchmark> perf;                                 ///< in the order of the rows
};

/// Reads and checks a manifest. Throws std::runtime_error with the first error: an unknown key, a value of
/// the wrong type, an unknown suite, or a world that does not exist in the folder of the manifest.
Manifest read_manifest(const std::filesystem::path& file);

/// Returns the runs that the shipped manifest lists for a suite. On an error, which an empty list also is,
/// prints the error and ends the program with exit code 2, because test programs call this before their tests
/// begin.
std::vector<Run> runs_of(std::string_view suite);

}  // namespace troupe::scenes
