#pragma once

#include "tests/support/paths.hpp"
#include "tests/support/scenes.hpp"

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <map>
#include <optional>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <tuple>

namespace troupe::test {

/// A run whose expected state hash is in worlds/golden_hashes.txt. The file has one line per GoldenRun;
/// `scripts/prove --golden` writes it.
struct GoldenRun {
  std::string world;  ///< file name in worlds/, followed by ":grid" if the run uses the grid ray engine
  std::optional<std::size_t> robots;  ///< number of robots; not set: as in the world file
  std::uint64_t ticks = 0;            ///< number of ticks (time steps) before the hash is computed

  friend auto operator<=>(const GoldenRun& a, const GoldenRun& b) {
    return std::tuple(a.world, a.robots.value_or(0), a.ticks) <=>
           std::tuple(b.world, b.robots.value_or(0), b.ticks);
  }
  friend bool operator==(const GoldenRun& a, const GoldenRun& b) { return a <=> b == 0; }
  friend std::ostream& operator<<(std::ostream& out, const GoldenRun& run) {
    return out << run.world << ", " << run.ticks << " ticks";
  }
};

/// Converts a run of a test suite to a GoldenRun. With the result, a test looks up the expected hash in
/// golden_hashes().
inline GoldenRun golden_run(const scenes::Run& run) {
  return {run.world + (run.by_grid ? ":grid" : ""), run.robots, run.ticks};
}

inline std::map<GoldenRun, std::string> golden_hashes() {
  std::map<GoldenRun, std::string> hashes;
  std::ifstream file(test::source_dir() / "worlds/golden_hashes.txt");
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line.starts_with('#')) continue;
    std::istringstream words(line);
    GoldenRun run;
    std::string robots;
    std::string hash;
    if (!(words >> run.world >> robots >> run.ticks >> hash))
      throw std::runtime_error("golden_hashes.txt: " + line);
    if (robots != "-") run.robots = std::stoul(robots);
    hashes[run] = hash;
  }
  return hashes;
}

}  // namespace troupe::test
