// Tests the mutators of the fuzz targets: most of their results are valid documents of the same language as
// the seed, and they contain keys that the seed does not have.

#include "tests/fuzz/json_mutator.hpp"
#include "tests/fuzz/stage_mutator.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/support/paths.hpp"
#include "troupe/registry.hpp"
#include "worldio/load.hpp"
#include "worldio/stage/stage_parser.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

namespace troupe::fuzz::mutator_test {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::IsSupersetOf;

constexpr std::uint32_t k_rounds = 400;

std::string content(const char* name) {
  std::ifstream stream(test::source_dir() / "tests/fuzz" / name, std::ios::binary);
  EXPECT_TRUE(stream) << name;
  return {std::istreambuf_iterator<char>(stream), {}};
}

void collect_keys(const nlohmann::json& json, std::set<std::string>& keys) {
  if (json.is_object())
    for (const auto& [key, value] : json.items()) keys.insert(key);
  for (const auto& value : json)
    if (value.is_structured()) collect_keys(value, keys);
}

std::size_t errors_of(const std::string& world) {
  Diagnostics diagnostics;
  worldio::LoadOptions options;
  options.threads = 1;
  options.most_bodies = 200;
  try {
    worldio::load_world_text(test::source_dir() / "tests/fuzz/files/fuzz.json", world, make_registry(),
                             options, diagnostics);
  } catch (const InputError&) {
  }
  return static_cast<std::size_t>(
      std::ranges::count(diagnostics.findings(), Severity::error, &Finding::severity));
}

TEST(JsonMutator, MakesDocumentsWithKeysThatTheSeedDoesNotHave) {
  const std::string seed = content("corpus/json/room.json");
  std::set<std::string> before, after;
  collect_keys(nlohmann::json::parse(seed), before);
  std::set<std::string> made;
  std::size_t readable = 0;
  for (std::uint32_t round = 0; round < k_rounds; ++round) {
    const std::string text = world_mutator().mutate(seed, round, nullptr);
    const auto json = nlohmann::json::parse(text, nullptr, false);
    ASSERT_FALSE(json.is_discarded()) << text;
    collect_keys(json, after);
    made.insert(text);
    if (round < 100) readable += errors_of(text) == 0 ? 1 : 0;
  }
  EXPECT_GT(made.size(), k_rounds * 9 / 10);
  EXPECT_GT(after.size(), before.size() + 100);
  // Random changes of bytes would make hardly any world that can be loaded.
  EXPECT_GT(readable, 5u);
}

TEST(JsonMutator, IsAFunctionOfTextAndSeed) {
  const std::string seed = content("corpus/json/experiment.json");
  for (std::uint32_t round = 0; round < 50; ++round)
    EXPECT_EQ(world_mutator().mutate(seed, round, nullptr), world_mutator().mutate(seed, round, nullptr));
}

TEST(JsonMutator, LeavesWhatIsNoJsonToOthers) {
  EXPECT_EQ(world_mutator().mutate("{\"a\": ", 1, nullptr), "");
  EXPECT_EQ(world_mutator().mutate(std::string(100, '['), 1, nullptr), "");
  EXPECT_EQ(world_mutator().mutate(std::string(100, '[') + std::string(100, ']'), 1, nullptr), "");
  EXPECT_EQ(world_mutator().cross("{}", "x", 1), "");
}

TEST(JsonMutator, CrossesDocuments) {
  const std::string first = content("corpus/json/room.json");
  const std::string second = content("corpus/json/experiment.json");
  std::set<std::string> made;
  for (std::uint32_t round = 0; round < 50; ++round) {
    const std::string text = world_mutator().cross(first, second, round);
    EXPECT_FALSE(nlohmann::json::parse(text, nullptr, false).is_discarded());
    made.insert(text);
  }
  EXPECT_GT(made.size(), 20u);
}

TEST(JsonMutator, KnowsTheWordsOfKinds) {
  EXPECT_THAT(world_mutator().words(), IsSupersetOf({"wander", "ranger", "diff", "poisson_disc"}));
  EXPECT_THAT(world_mutator().keys(), IsSupersetOf({"stop_when", "range_max_m", "fov_deg"}));
  EXPECT_THAT(study_mutator().words(), Contains("coverage"));
}

TEST(StageMutator, MakesWorldsThatAreStillNested) {
  const std::string seed = content("corpus/stage/models.world");
  std::set<std::string> made;
  std::size_t without_errors = 0;
  for (std::uint32_t round = 0; round < k_rounds; ++round) {
    const std::string text = mutate_stage(seed, round);
    made.insert(text);
    Diagnostics diagnostics;
    try {
      without_errors +=
          worldio::parse_stage("fuzz.world", text, {}, diagnostics).well_nested && !diagnostics.has_errors();
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(made.size(), k_rounds * 9 / 10);
  EXPECT_GT(without_errors, k_rounds / 2);
  EXPECT_EQ(mutate_stage(seed, 7), mutate_stage(seed, 7));
  EXPECT_EQ(mutate_stage("# only a comment", 1), "");
}

// Reads a fixed set of mutated inputs in every build, with its sanitizers, as libFuzzer does for hours.
TEST(Mutated, SeedsAreReadToTheEnd) {
  for (const char* seed :
       {"corpus/json/room.json", "corpus/json/experiment.json", "corpus/json/script.json"}) {
    std::string text = content(seed);
    for (std::uint32_t round = 0; round < 60; ++round) {
      SCOPED_TRACE(text);
      const std::string next = world_mutator().mutate(text, round, nullptr);
      if (next.size() < 16384) text = next;
      read_json(text);
      if (round % 6 == 5) text = content(seed);
    }
  }
  for (const char* seed : {"corpus/stage/models.world", "corpus/stage/room.world", "corpus/stage/odd.world"})
    for (std::uint32_t round = 0; round < 60; ++round) read_stage(mutate_stage(content(seed), round));
  for (std::uint32_t round = 0; round < 60; ++round)
    read_study(study_mutator().mutate(content("corpus/study/samples.json"), round, nullptr));
}

}  // namespace
}  // namespace troupe::fuzz::mutator_test
