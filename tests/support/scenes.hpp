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
/// described in docs/worlds.md. scripts/proofs/scenes.py reads the same file for everything else; it checks
/// all keys but `tests` and `perf`.
namespace troupe::scenes {

/// A run of a shipped world in a test suite. Each suite says which of these a run may give; the others keep
/// their defaults.
struct Run {
  std::string world;                       ///< file name in worlds/
  bool by_grid = false;                    ///< by the grid ray engine instead of the world's own
  std::optional<std::size_t> robots;       ///< of the world's only population; none: as the world says
  std::optional<std::size_t> robots_slow;  ///< the same in builds that are slow
  std::uint64_t warm_ticks = 0;            ///< before anything is tested
  std::uint64_t ticks = 0;
  unsigned threads = 1;

  std::filesystem::path file() const;
  /// Unique in its suite, of letters, digits and underscores: `crowdByGrid`.
  std::string name() const;
  friend std::ostream& operator<<(std::ostream& out, const Run& run) { return out << run.name(); }
};

/// A variant of a benchmark's world, timed in turn with it.
struct Variant {
  std::string name;
  std::vector<std::pair<std::string, std::string>> set;  ///< JSON pointer and value, as --set takes them
};

/// Rows of perf_paper's tables: a world with these numbers of robots.
struct Benchmark {
  std::string world;  ///< file name in worlds/
  std::string table;  ///< id of the table
  std::vector<std::size_t> robots;
  std::vector<std::size_t> quick;        ///< numbers of robots with --quick
  std::vector<std::string> populations;  ///< that share the robots equally; empty: the world's only one
  std::optional<double> for_s;           ///< instead of the table's time
  std::vector<Variant> beside;
  bool as_text = false;  ///< memory alone: also as .world text, and without robots
};

struct Manifest {
  std::map<std::string, std::vector<Run>, std::less<>> tests;  ///< by suite
  std::vector<Benchmark> perf;                                 ///< in the order of the rows
};

/// Reads and checks a manifest. Throws std::runtime_error with the first finding: a key that is not known, a
/// value of the wrong type, a suite that is not known, a world that does not exist beside the manifest.
Manifest read_manifest(const std::filesystem::path& file);

/// The runs that the shipped manifest lists for a suite; an empty list is an error, too. What is wrong is
/// printed, and ends the program with 2: test programs ask before they have started.
std::vector<Run> runs_of(std::string_view suite);

}  // namespace troupe::scenes
