// The reader of worlds/scenes.json that tests and benchmarks share: its errors name the line.

#include "tests/support/paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/scratch.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <stdexcept>
#include <string>

namespace troupe::scenes::manifest_test {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class ManifestTest : public test::ScratchTest {
 protected:
  /// A manifest of one row, beside its world.
  std::filesystem::path manifest(const std::string& more) {
    write("a.json", "{}");
    return write("scenes.json",
                 fmt::format(R"({{"worlds": [{{"world": "a.json", "moves": "x", "for": "y"{}}}]}})", more));
  }
  std::string error_of(const std::filesystem::path& file) const {
    try {
      read_manifest(file);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "no error";
  }
};

TEST_F(ManifestTest, GivesTheRunsOfASuiteAndTheRowsOfATable) {
  const Manifest read = read_manifest(manifest(R"(, "tests": {
      "allocations": [{"warm_ticks": 20, "ticks": 100}],
      "reset": [{}, {"threads": 3, "ranging": "grid"}]},
    "perf": [{"table": "devices", "robots": [1, 2], "quick": [1], "populations": ["r"], "for_s": 1.5,
              "beside": [{"name": "a-off", "set": {"/x": "false"}}]}])"));
  const scenes::Run& warm = read.tests.at("allocations").at(0);
  EXPECT_EQ(warm.world, "a.json");
  EXPECT_EQ(warm.warm_ticks, 20u);
  EXPECT_EQ(warm.ticks, 100u);
  EXPECT_FALSE(warm.robots);
  EXPECT_EQ(read.tests.at("reset").at(0).name(), "a");
  EXPECT_EQ(read.tests.at("reset").at(1).name(), "aByGridOn3Threads");
  const Benchmark& row = read.perf.at(0);
  EXPECT_EQ(row.table, "devices");
  EXPECT_EQ(row.robots, (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(row.for_s, 1.5);
  EXPECT_EQ(row.beside.at(0).set.at(0), (std::pair<std::string, std::string>("/x", "false")));
}

TEST_F(ManifestTest, NamesWhatIsWrongAndWhere) {
  const struct {
    const char* row;
    const char* expected;
  } cases[] = {
      {R"(, "test": {})",
       "/worlds/0/test: unknown key; known: world, moves, for, excluded, slow, prove, golden, tests, perf, "
       "gallery, soak"},
      {R"(, "tests": {"alocations": []})",
       "/worlds/0/tests/alocations: unknown key; known: allocations, checkpoint, convert, energy, "
       "experiments, grips, lint, "
       "reset, same_bits, same_bits_slow, store"},
      {R"(, "tests": {"reset": [{}, {"ticks": 3}]})",
       "/worlds/0/tests/reset/1/ticks: unknown key; known: ranging, threads"},
      {R"(, "tests": {"same_bits": [{"robots": 3}]})",
       "/worlds/0/tests/same_bits/0: the key \"ticks\" is missing"},
      {R"(, "tests": {"same_bits": [{"ticks": -1}]})",
       "/worlds/0/tests/same_bits/0/ticks: expected a whole number, found -1"},
      {R"(, "tests": {"same_bits": [{"ticks": 1, "ranging": "fast"}]})",
       "/worlds/0/tests/same_bits/0/ranging: \"fast\"; known: grid"},
      {R"(, "tests": {"same_bits": {}})", "/worlds/0/tests/same_bits: expected a list, found {}"},
      {R"(, "perf": [{"table": "1", "robots": [1]}])",
       "/worlds/0/perf/0: needs numbers of robots, \"robots\" and \"quick\""},
      {R"(, "perf": [{"table": "1", "robots": ["1"], "quick": [1]}])",
       "/worlds/0/perf/0/robots/0: expected a whole number, found \"1\""},
      {R"(}, {"world": "b.json")", "/worlds/1/world: there is no world b.json in "},
      {R"(}, {"world": "a.json")", "/worlds/1/world: a.json has two rows"},
  };
  for (const auto& [row, expected] : cases) {
    const std::string error = error_of(manifest(row));
    EXPECT_THAT(error, StartsWith((folder_ / "scenes.json").string() + ": error: " + expected));
  }
  EXPECT_THAT(error_of(write("scenes.json", "{\"worlds\": [}")),
              HasSubstr("scenes.json: error: /: [json.exception.parse_error"));
  EXPECT_THAT(error_of(folder_ / "none.json"), EndsWith("none.json: error: /: cannot be read"));
}

TEST_F(ManifestTest, OfTheShippedWorldsNamesEveryRunOfASuiteOnce) {
  const Manifest shipped = read_manifest(test::source_dir() / "worlds/scenes.json");
  EXPECT_GE(shipped.tests.at("allocations").size(), 20u);
  EXPECT_GE(shipped.perf.size(), 20u);
  for (const auto& [suite, runs] : shipped.tests) {
    std::set<std::string> names;
    for (const scenes::Run& run : runs) EXPECT_TRUE(names.insert(run.name()).second) << suite << ": " << run;
  }
}

}  // namespace
}  // namespace troupe::scenes::manifest_test
