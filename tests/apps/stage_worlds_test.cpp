#include "tests/apps/program.hpp"
#include "tests/support/paths.hpp"

#include <nlohmann/json.hpp>

namespace troupe::apps::stage_worlds_test {
namespace {

using ::testing::Each;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::Not;

struct StageWorld {
  std::string file;  ///< below the source folder
  std::size_t robots;
  std::string seconds;  ///< the large ones are cut short: their cost is most of what these tests take
};

void PrintTo(const StageWorld& world, std::ostream* out) {
  *out << world.file << ", " << world.seconds << " s";
}

class StageWorlds : public ProgramTest, public ::testing::WithParamInterface<StageWorld> {};

TEST_P(StageWorlds, RunUnmodified) {
  const std::filesystem::path world = test::source_dir() / GetParam().file;
  if (!std::filesystem::exists(world)) GTEST_SKIP() << "Stage's data are not in " << world;
  const Outcome outcome = troupe({"run", world, "--for", GetParam().seconds, "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json.at("robots"), GetParam().robots);
  EXPECT_EQ(json.at("ticks"), 10 * std::stoi(GetParam().seconds));
  // What is not honoured is said, each at its place.
  EXPECT_THAT(lines_of(outcome.err), Not(IsEmpty()));
  EXPECT_THAT(lines_of(outcome.err), Each(MatchesRegex(".*/[a-z_]+\\.(world|inc):[0-9]+: warning: .+")));
}

class Conformance14 : public ProgramTest {};

// Stage's program takes no notice of a world that does not load, and then waits for ever.
TEST_F(Conformance14, AWorldThatDoesNotLoadIsExitCode2) {
  write("parts.inc", "\n\nfoo bar\n");
  write("bad.world", "include \"parts.inc\"\nmodel( size [1, 1 1] )\nmodel( pose [1] )\n");
  const Outcome outcome = troupe({"run", "bad.world", "--for", "1"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(
      lines_of(outcome.err),
      ::testing::ElementsAre(  // what no file may hold is found before what makes no sense
          "bad.world:2: error: unexpected ','; the values of a tuple are separated by blanks: [1 2 3]",
          "parts.inc:3: error: the value of \"foo\" must be a number, a string or a tuple; a string needs "
          "quotes: foo \"bar\"",
          "bad.world:3: error: \"pose\" needs 4 values [x y z heading], found 1"));
}

std::string name_of(const ::testing::TestParamInfo<StageWorld>& test) {
  return std::filesystem::path(test.param.file).stem().string();
}

const std::string k_stage = "../shared/stage-worlds/";
INSTANTIATE_TEST_SUITE_P(Apps, StageWorlds,
                         ::testing::Values(StageWorld{k_stage + "benchmark/hospital.world", 1000, "2"},
                                           StageWorld{k_stage + "benchmark/cave.world", 100, "2"},
                                           StageWorld{k_stage + "simple.world", 2, "30"},
                                           StageWorld{k_stage + "pioneer_walle.world", 2, "30"},
                                           StageWorld{k_stage + "roomba.world", 1, "30"},
                                           StageWorld{k_stage + "sensor_noise_demo.world", 1, "30"}),
                         name_of);

const std::string k_styles = "tests/troupe/stage_styles/";
INSTANTIATE_TEST_SUITE_P(InStagesSyntax, StageWorlds,
                         ::testing::Values(StageWorld{"tests/stage_like/swarm.world", 24, "10"},
                                           StageWorld{k_styles + "demo.world", 2, "30"},
                                           StageWorld{k_styles + "blocks.world", 2, "30"},
                                           StageWorld{k_styles + "disc.world", 1, "30"},
                                           StageWorld{k_styles + "noise.world", 1, "30"},
                                           StageWorld{k_styles + "flock.world", 16, "10"}),
                         name_of);

}  // namespace
}  // namespace troupe::apps::stage_worlds_test
