// World files of all earlier versions of the format are still read with the same results. The files in
// tests/worldio/formats are never changed.

#include "base/hash.hpp"
#include "tests/support/paths.hpp"
#include "troupe/registry.hpp"
#include "troupe/simulation.hpp"
#include "worldio/json/spec_difference.hpp"
#include "worldio/json/world_document.hpp"
#include "worldio/load.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace troupe::worldio::formats_test {
namespace {

namespace fs = std::filesystem;

engine::WorldSpec world_of(const fs::path& file) {
  Diagnostics diagnostics;
  engine::WorldSpec spec = load_world(file, make_registry(), {}, diagnostics);
  diagnostics.throw_if_errors();
  return spec;
}

TEST(Formats, FilesOfEveryVersionAreReadAsBefore) {
  const fs::path folder = test::source_dir() / "tests/worldio/formats";
  std::ifstream stream(folder / "hashes.txt");
  std::int64_t versions = 0;
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line.starts_with('#')) continue;
    ++versions;
    SCOPED_TRACE(line);
    std::istringstream words(line);
    std::string name, hash;
    std::uint64_t ticks = 0;
    ASSERT_TRUE(words >> name >> ticks >> hash);
    EXPECT_EQ(name, "world_" + std::to_string(versions));
    const fs::path file = folder / (name + ".json");
    EXPECT_EQ(spec_difference(world_of(file), world_of(folder / (name + ".expanded.json"))), "");
    SimulationOptions options;
    options.threads = 2;
    Simulation simulation(file, options);
    while (simulation.tick() < ticks) simulation.step();
    EXPECT_EQ(hex(simulation.state_hash()), hash);
  }
  EXPECT_EQ(versions, k_format_version) << "a version of the format has no files in " << folder;
}

}  // namespace
}  // namespace troupe::worldio::formats_test
