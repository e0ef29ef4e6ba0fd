#include "tests/apps/program.hpp"
#include "tests/support/paths.hpp"

namespace troupe::apps::convert_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

constexpr std::string_view k_world =
    "define box model( size [1 1 1] )\n"
    "box( name \"a\" pose [1 0 0 30] )\n"
    "box( name \"b\" pose [3 0 0 0] )\n"
    "position( name \"r\" pose [-2 0 0 45] size [0.3 0.3 0.3] ctrl \"script law=wave\" )\n";

class ConvertCommand : public ProgramTest {
 protected:
  /// The log of a run, without what says which world it was.
  std::string hashes(const std::string& world) {
    const Outcome outcome = troupe({"run", world, "--for", "2", "--hash-log", "hash.log", "--quiet"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    std::string lines;
    for (const std::string& line : lines_of(read("hash.log")))
      if (!line.starts_with('#')) lines += line + '\n';
    return lines;
  }
  Outcome refused(const std::vector<std::string>& arguments) {
    const std::vector<std::string> before = files();
    Outcome outcome = troupe(arguments);
    EXPECT_EQ(outcome.code, 2) << outcome.out;
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
    EXPECT_EQ(files(), before) << "something was written";
    return outcome;
  }
};

TEST_F(ConvertCommand, SaysInALineWhatItWrote) {
  write("w.world", k_world);
  const Outcome outcome = troupe({"convert", "w.world", "w.json"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "w.json: 3 models of 2 types, from w.world\n");
  EXPECT_THAT(outcome.err, IsEmpty());
  EXPECT_THAT(files(), ElementsAre("w.json", "w.world"));
  const std::string log = hashes("w.world");
  EXPECT_EQ(hashes("w.json"), log);
  EXPECT_EQ(troupe({"convert", "w.json", "again.world"}).code, 0);
  EXPECT_EQ(hashes("again.world"), log);
}

TEST_F(ConvertCommand, WorldsWithHeadingsBeyondHalfATurnHaveOneLogInBothFormats) {
  const std::string worlds = test::source_dir().string() + "/worlds/";
  ASSERT_EQ(troupe({"convert", worlds + "crowd.json", "crowd.world"}).code, 0);
  EXPECT_EQ(hashes("crowd.world"), hashes(worlds + "crowd.json"));
  const std::vector<std::string> few{"--set", "/populations/0/count=30"};
  ASSERT_EQ(troupe({"convert", worlds + "hospital.json", "few.json", few[0], few[1]}).code, 0);
  ASSERT_EQ(troupe({"convert", worlds + "hospital.json", "few.world", few[0], few[1]}).code, 0);
  EXPECT_EQ(hashes("few.world"), hashes("few.json"));
}

TEST_F(ConvertCommand, AFileThatIsThereIsReplacedOnlyWithForce) {
  write("w.world", k_world);
  write("w.json", "mine");
  EXPECT_EQ(refused({"convert", "w.world", "w.json"}).err,
            "w.json: error: the file exists; --force replaces it\n");
  EXPECT_EQ(read("w.json"), "mine");
  EXPECT_EQ(troupe({"convert", "w.world", "w.json", "--force"}).code, 0);
  EXPECT_THAT(read("w.json"), StartsWith("{\n  \"troupe\": 1,\n"));
  EXPECT_THAT(refused({"convert", "w.world", "w.world", "--force"}).err,
              HasSubstr("w.world: error: cannot be written: it is the world, which this command reads: "
                        "choose another file name"));
}

TEST_F(ConvertCommand, AnIncludedFileIsNotReplaced) {
  const std::string types = R"({"types": {"box": {"size_m": [1, 1, 1]}}})";
  write("types.json", types);
  write("all.json", R"({"troupe": 1, "include": ["types.json"]})");
  const Outcome outcome = troupe({"convert", "all.json", "types.json", "--force"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("types.json: error: cannot be written: it is a file of the world, which "
                                     "this command reads: choose another file name"));
  EXPECT_EQ(read("types.json"), types);
}

TEST_F(ConvertCommand, NothingIsWrittenOfAWorldThatIsWrong) {
  write("w.world", "model( size [1 0 1] )\n");
  EXPECT_THAT(refused({"convert", "w.world", "w.json"}).err, StartsWith("w.world:1: error: \"size\""));
  EXPECT_THAT(refused({"convert", "none.world", "w.json"}).err,
              HasSubstr("none.world: error: there is no such"));
  write("good.world", k_world);
  EXPECT_THAT(refused({"convert", "good.world", "w.yaml"}).err,
              HasSubstr("w.yaml: error: the name of a world file must end in .world"));
  EXPECT_THAT(refused({"convert", "good.world", "nowhere/w.json"}).err,
              HasSubstr("there is no folder nowhere"));
  write("w.json", R"({"troupe": 1,
 "ranging": "grid"})");
  EXPECT_EQ(refused({"convert", "w.json", "out.world"}).err,
            "w.json:2: error: a .world file cannot express this: \"ranging\": remove this key, and choose "
            "the ray engine with troupe run --raytracer\n");
}

TEST_F(ConvertCommand, SetReachesIntoWhatIsWritten) {
  write("w.world", k_world);
  ASSERT_EQ(
      troupe({"convert", "w.world", "w.json", "--set", "/models/1/pose/x_m=7", "--set", "/seed=9"}).code, 0);
  EXPECT_THAT(read("w.json"),
              AllOf(HasSubstr("\"x_m\": 7"), HasSubstr("\"seed\": 9"), Not(HasSubstr("\"x_m\": 3"))));
  // The same pointers, when the world itself is run.
  const Outcome outcome = troupe({"run", "w.world", "--for", "1", "--quiet", "--hash-log", "a.log", "--set",
                                  "/models/1/pose/x_m=7", "--set", "/seed=9"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(troupe({"run", "w.json", "--for", "1", "--quiet", "--hash-log", "b.log"}).code, 0);
  EXPECT_EQ(lines_of(read("a.log")).back(), lines_of(read("b.log")).back());
  EXPECT_THAT(refused({"convert", "w.world", "x.json", "--set", "/models/9/pose/x_m=7"}).err,
              StartsWith("--set /models/9/pose/x_m: error: /models is a list of length 3"));
}

TEST_F(ConvertCommand, SaysWhatItDoes) {
  const Outcome outcome = troupe({"convert", "--help"});
  EXPECT_EQ(outcome.code, 0);
  for (const char* word :
       {"IN", "OUT", "--force", "--set", "--plugin-path", "--controller", "Examples:", "Exit codes:"})
    EXPECT_THAT(outcome.out, HasSubstr(word));
  EXPECT_THAT(refused({"convert", "w.world"}).err, HasSubstr("OUT is required"));
}

}  // namespace
}  // namespace troupe::apps::convert_test
