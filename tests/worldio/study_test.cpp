#include "worldio/json/study.hpp"

#include "tests/support/scratch.hpp"
#include "tests/worldio/json_test_world.hpp"
#include "troupe/registry.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cfenv>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

namespace troupe::worldio::study_test {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class StudyFile : public test::ScratchTest {
 protected:
  Study study(const std::string& members) {
    std::ofstream(file_) << "{\"troupe_study\": 1, \"world\": \"w/hall.json\""
                         << (members.empty() ? "" : ",\n") << members << "}";
    diagnostics_ = Diagnostics();
    return load_study(file_, make_registry(), diagnostics_);
  }
  std::vector<std::string> wrong(const std::string& members) {
    study(members);
    std::vector<std::string> texts;
    for (const std::string& text : findings(diagnostics_))
      texts.push_back(text.substr(text.rfind("study.json")));
    return texts;
  }
  std::vector<std::vector<std::string>> values(const std::string& members) {
    std::vector<std::vector<std::string>> all;
    const Study read = study(members);
    for (std::size_t r = 0; r < read.run_count(); ++r) all.push_back(read.run(r).values);
    EXPECT_THAT(findings(diagnostics_), IsEmpty());
    return all;
  }

  std::filesystem::path file_ = folder_ / "study.json";
  Diagnostics diagnostics_;
};

// A library may have changed the arithmetic of the process.
TEST_F(StudyFile, IsReadWithTheDefaultRounding) {
  const std::string members = R"("parameters": [{"set": "/speed", "values": [0.3, 0.7]}])";
  const std::vector<std::vector<std::string>> expected = values(members);
  std::fesetround(FE_UPWARD);
  const std::vector<std::vector<std::string>> got = values(members);
  std::fesetround(FE_TONEAREST);
  EXPECT_EQ(got, expected);
}

TEST_F(StudyFile, MayNameManyMeasuresOfTheWorld) {
  constexpr int k_measures = 10000;  // reading the world again for each of them would take minutes
  std::string of_world, of_study;
  for (int i = 0; i < k_measures; ++i) {
    of_world += fmt::format("{}{{\"kind\": \"stalls\", \"name\": \"m{}\"}}", i > 0 ? ",\n" : "", i);
    of_study += fmt::format("{}\"m{}\"", i > 0 ? ", " : "", i);
  }
  std::filesystem::create_directory(file_.parent_path() / "w");
  std::ofstream(file_.parent_path() / "w/hall.json") << "{\"troupe\": 1, \"measures\": [" << of_world << "]}";
  EXPECT_THAT(study("\"measures\": [" + of_study + "]").measures, SizeIs(k_measures));
  EXPECT_THAT(findings(diagnostics_), IsEmpty());
}

TEST_F(StudyFile, WithoutParametersIsOneRunOfTheWorldBesideIt) {
  const Study one = study("");
  EXPECT_EQ(one.world, file_.parent_path() / "w/hall.json");
  ASSERT_EQ(one.run_count(), 1u);
  EXPECT_THAT(one.run(0).values, IsEmpty());
  EXPECT_FALSE(one.run(0).seed || one.for_s);
  EXPECT_THAT(one.statistics, ElementsAre(Statistic::last));
  EXPECT_EQ(one.measure_every_s, 1);
}

TEST_F(StudyFile, AGridIsAllCombinationsTheFirstSlowestAndSeedsFastest) {
  const Study grid = study(R"("for_ms": 500, "parameters": [
    {"set": "/a/0/b", "values": [1, "two", {"x": [3]}]}, {"set": "/c", "name": "gain", "from": 0, "to": 1, "steps": 3}],
    "seeds": [7, 5])");
  EXPECT_EQ(grid.for_s, 0.5);
  ASSERT_EQ(grid.run_count(), 3u * 3 * 2);
  EXPECT_THAT(grid.run(0).values, ElementsAre("1", "0"));
  EXPECT_EQ(grid.run(0).seed, 7u);
  EXPECT_EQ(grid.run(1).seed, 5u);
  EXPECT_THAT(grid.run(2).values, ElementsAre("1", "0.5"));
  EXPECT_THAT(grid.run(17).values, ElementsAre("{\"x\": [3]}", "1"));
  EXPECT_EQ(grid.parameters[0].name, "a.0.b");
  EXPECT_EQ(grid.parameters[1].name, "gain");
  EXPECT_THAT(grid.settings(grid.run(7)),
              ElementsAre(testing::Pair("/a/0/b", "\"two\""), testing::Pair("/c", "0")));
}

TEST_F(StudyFile, ParametersVaryTogetherInTheOrderOfTheirLists) {
  const Study study_of_four = study(R"("parameters": [
    {"set": "/n", "name": "robots", "values": [2, 4]}, {"set": "/v", "values": [1, 9]},
    {"set": "/a", "values": [5, 5], "with": "robots"}, {"set": "/b", "from": 0.5, "to": 1, "steps": 2, "with": "a"}],
    "seeds": [7, 5])");
  EXPECT_THAT(findings(diagnostics_), IsEmpty());
  ASSERT_EQ(study_of_four.run_count(), 2u * 2 * 2);
  std::vector<std::vector<std::string>> rows;
  for (std::size_t r = 0; r < study_of_four.run_count(); r += 2) rows.push_back(study_of_four.run(r).values);
  EXPECT_THAT(rows, ElementsAre(ElementsAre("2", "1", "5", "0.5"), ElementsAre("2", "9", "5", "0.5"),
                                ElementsAre("4", "1", "5", "1"), ElementsAre("4", "9", "5", "1")));
  EXPECT_EQ(study_of_four.run(7).seed, 5u);
  // The combinations differ, although no list does.
  EXPECT_EQ(
      study(
          R"("parameters": [{"set": "/n", "values": [2, 2, 4]}, {"set": "/a", "values": [1, 2, 2], "with": "n"},
    {"set": "/b", "from": 3, "to": 3, "steps": 3, "with": "n"}])")
          .run_count(),
      3u);
  EXPECT_THAT(findings(diagnostics_), IsEmpty());
}

TEST_F(StudyFile, SamplesOfParametersThatVaryTogetherHaveOnePosition) {
  const auto rows = values(R"("samples": 40, "parameters": [
    {"set": "/n", "values": [2, 4, 8]}, {"set": "/m", "values": ["a", "b", "c"], "with": "n"},
    {"set": "/x", "from": 1, "to": 3, "steps": 3, "with": "n"}])");
  EXPECT_THAT(std::set<std::vector<std::string>>(rows.begin(), rows.end()),
              ElementsAre(ElementsAre("2", "\"a\"", "1"), ElementsAre("4", "\"b\"", "2"),
                          ElementsAre("8", "\"c\"", "3")));
}

TEST_F(StudyFile, SaysWhichParametersCannotVaryTogether) {
  const auto wrong_second = [&](const std::string& members, const std::string& more = "") {
    return wrong("\"parameters\": [{\"set\": \"/n\", \"values\": [2, 4]},\n{\"set\": \"/a\", " + members +
                 "}]" + more);
  };
  EXPECT_THAT(
      wrong_second(R"("values": [1, 2, 3], "with": "n")"),
      ElementsAre("study.json:3: error: /parameters/1/with: the number of values is 3, but \"n\" has 2: "
                  "give both the same number of values"));
  EXPECT_THAT(wrong_second(R"("from": 1, "to": 2, "steps": 5, "with": "n")", R"(, "samples": 3)"),
              ElementsAre(HasSubstr("/with: the number of values is 5, but \"n\" has 2")));
  EXPECT_THAT(
      wrong_second(R"("values": [1, 2], "with": "m")"),
      ElementsAre("study.json:3: error: /parameters/1/with: unknown earlier parameter \"m\"; known: n"));
  EXPECT_THAT(wrong_second(R"("values": [1, 2], "with": "a")"),
              ElementsAre(HasSubstr("unknown earlier parameter \"a\"; known: n")));
  EXPECT_THAT(wrong_second(R"("values": [1, 2], "with": 0)"),
              ElementsAre(HasSubstr("/with: expected the name of an earlier parameter, found the number 0")));
  EXPECT_THAT(
      wrong_second(R"("uniform": [1, 2], "with": "n")", R"(, "samples": 3)"),
      ElementsAre("study.json:3: error: /parameters/1/with: values that vary together are at the same "
                  "position of two lists: instead of random numbers, give this parameter \"values\", or "
                  "\"from\", \"to\" and \"steps\""));
  EXPECT_THAT(
      wrong(R"("samples": 3, "parameters": [{"set": "/n", "integers": [2, 4]},
    {"set": "/a", "values": [1, 2], "with": "n"}])"),
      ElementsAre(HasSubstr("study.json:3: error: /parameters/1/with: values that vary together are at the "
                            "same position of two lists: instead of random numbers, give \"n\" ")));
  EXPECT_THAT(wrong_second(R"("values": [], "with": "n")"),
              ElementsAre(HasSubstr("expected a list of 1 to")));
  EXPECT_THAT(
      wrong("\"parameters\": [{\"set\": \"/n\", \"values\": [2, 4, 4.0,\n2]},\n"
            "{\"set\": \"/a\", \"values\": [1, 2, 3, 1], \"with\": \"n\"}]"),
      ElementsAre("study.json:3: error: /parameters/0/values/3: the lists that vary together already contain "
                  "this combination of values: remove one of the two"));
}

TEST_F(StudyFile, StepsEndAtTheLastValueExactly) {
  EXPECT_THAT(values(R"("parameters": [{"set": "/x", "from": 0.1, "to": 0.7, "steps": 7}])").back(),
              ElementsAre("0.7"));
}

TEST_F(StudyFile, StepsAreTheNumbersOfFewestDigits) {
  const auto steps = [&](const std::string& members) {
    std::vector<std::string> all;
    for (const std::vector<std::string>& row : values("\"parameters\": [{\"set\": \"/x\", " + members + "}]"))
      all.push_back(row.front());
    return all;
  };
  EXPECT_THAT(steps(R"("from": 0.1, "to": 0.5, "steps": 5)"), ElementsAre("0.1", "0.2", "0.3", "0.4", "0.5"));
  EXPECT_THAT(steps(R"("from": 1.1, "to": -0.1, "steps": 4)"), ElementsAre("1.1", "0.7", "0.3", "-0.1"));
  EXPECT_THAT(steps(R"("from": 1e-7, "to": 3e-7, "steps": 3)"), ElementsAre("1e-07", "2e-07", "3e-07"));
  EXPECT_THAT(steps(R"("from": 0, "to": 1, "steps": 4)"),
              ElementsAre("0", "0.3333333333333333", "0.6666666666666666", "1"));
  EXPECT_THAT(steps(R"("from": 1e300, "to": 3e300, "steps": 3)"), ElementsAre("1e+300", "2e+300", "3e+300"));
  EXPECT_THAT(steps(R"("from": 0.1234567890123456, "to": 0.3234567890123456, "steps": 3)"),
              ElementsAre("0.1234567890123456", "0.2234567890123456", "0.3234567890123456"));
  const std::vector<std::string> thousandths = steps(R"("from": -0.5, "to": 0.5, "steps": 1001)");
  ASSERT_THAT(thousandths, SizeIs(1001));
  for (std::size_t i = 0; i < 1001; ++i)
    EXPECT_EQ(thousandths[i], fmt::format("{}", (static_cast<double>(i) - 500) / 1000));
}

TEST_F(StudyFile, SamplesAreDrawnWithinTheirIntervals) {
  const auto drawn = values(R"("samples": 500, "parameters": [{"set": "/u", "uniform": [-1, 3]},
    {"set": "/l", "log_uniform": [0.01, 100]}, {"set": "/i", "integers": [3, 6]}, {"set": "/v", "values": ["a", "b"]}])");
  ASSERT_THAT(drawn, SizeIs(500));
  std::set<std::string> integers, listed;
  double below_one = 0;
  for (const auto& row : drawn) {
    EXPECT_GE(std::stod(row[0]), -1);
    EXPECT_LT(std::stod(row[0]), 3);
    EXPECT_GE(std::stod(row[1]), 0.01);
    EXPECT_LE(std::stod(row[1]), 100);
    below_one += std::stod(row[1]) < 1;
    integers.insert(row[2]);
    listed.insert(row[3]);
  }
  EXPECT_THAT(integers, ElementsAre("3", "4", "5", "6"));
  EXPECT_THAT(listed, ElementsAre("\"a\"", "\"b\""));
  EXPECT_NEAR(below_one / 500, 0.5, 0.09);  // half of the decades; four standard deviations
}

TEST_F(StudyFile, SamplesOfOneParameterDependNeitherOnTheOthersNorOnTheirNumber) {
  const auto column = [](const std::vector<std::vector<std::string>>& rows, std::size_t at) {
    std::vector<std::string> cells;
    for (const auto& row : rows) cells.push_back(row[at]);
    return cells;
  };
  const auto alone = column(values(R"("samples": 3, "parameters": [{"set": "/u", "uniform": [0, 1]}])"), 0);
  auto more = column(
      values(
          R"("samples": 9, "parameters": [{"set": "/n", "integers": [1, 9]}, {"set": "/u", "uniform": [0, 1]}])"),
      1);
  more.resize(3);
  EXPECT_EQ(alone, more);
  EXPECT_NE(
      alone,
      column(values(R"("samples": 3, "random_seed": 2, "parameters": [{"set": "/u", "uniform": [0, 1]}])"),
             0));
}

TEST_F(StudyFile, ParametersThatAppendToOneListDrawDifferentValues) {
  std::set<std::vector<std::string>> rows;
  for (const auto& row : values(R"("samples": 32, "parameters": [
    {"set": "/models/-", "name": "a", "values": [1, 2]}, {"set": "/models/-", "name": "b", "values": [1, 2]}])"))
    rows.insert(row);
  EXPECT_THAT(rows, SizeIs(4));
}

// A few kilobytes that ask for a million runs of 300 parameters, two of whose values are long: kept, they
// would take 100 GB.
TEST_F(StudyFile, RunsAreMadeOnDemand) {
  std::string parameters;
  for (int p = 0; p < 300; ++p)
    parameters += fmt::format("{{\"set\": \"/p{}\", \"from\": 0, \"to\": 1, \"steps\": 1000000}},", p);
  parameters += fmt::format("{{\"set\": \"/long\", \"values\": [\"{}\"]}}", std::string(8000, 'x'));
  const Study large = study(fmt::format("\"samples\": 1000000, \"parameters\": [{}]", parameters));
  EXPECT_THAT(findings(diagnostics_), IsEmpty());
  ASSERT_EQ(large.run_count(), 1000000u);
  EXPECT_THAT(large.run(999999).values, SizeIs(301));
  EXPECT_NE(large.run(0).values, large.run(999999).values);
}

TEST_F(StudyFile, ValuesAreFiniteOrAnError) {
  EXPECT_THAT(wrong(R"("parameters": [{"set": "/x", "from": -1e308, "to": 1e308, "steps": 3}])"),
              ElementsAre(HasSubstr("differ by more than")));
  EXPECT_THAT(wrong(R"("samples": 1, "parameters": [{"set": "/x", "uniform": [-1e308, 1e308]}])"),
              ElementsAre(HasSubstr("differ by more than")));
  const auto drawn = values(
      R"("samples": 50, "parameters": [{"set": "/x", "log_uniform": [1e308, 1.7976931348623157e308]}])");
  for (const auto& row : drawn) EXPECT_LE(std::stod(row[0]), 1.7976931348623157e308);
}

TEST_F(StudyFile, NamesOfColumnsAreUnique) {
  const auto errors = [&](const std::string& members, const std::vector<std::string>& measures) {
    const Study read = study(members);
    EXPECT_THAT(findings(diagnostics_), IsEmpty());
    check_columns(read, measures, diagnostics_);
    std::vector<std::string> texts;
    for (const std::string& text : findings(diagnostics_))
      texts.push_back(text.substr(text.rfind("study.json")));
    return texts;
  };
  EXPECT_THAT(errors(R"("statistics": ["last", "mean"])", {"x", "y"}), IsEmpty());
  const std::string parameter = R"("parameters": [
    {"set": "/x", "values": [1]},
    {"set": "/y", "name": "coverage_mean", "values": [1]}], "statistics": ["mean"])";
  EXPECT_THAT(errors(parameter, {"cover"}), IsEmpty());
  EXPECT_THAT(errors(parameter, {"coverage"}),
              ElementsAre("study.json:4: error: /parameters/1: the table of results already has a column "
                          "\"coverage_mean\", that of a measure: give this parameter another \"name\""));
  EXPECT_THAT(errors(parameter, {"x"}), ElementsAre(HasSubstr("study.json:3: error: /parameters/0")));
  EXPECT_THAT(errors(R"("statistics": ["mean"])", {"run"}),
              ElementsAre("study.json: error: the table of results already has a column \"run\": give the "
                          "measure of this column another \"name\""));
  EXPECT_THAT(errors(R"("statistics": ["last", "mean"])", {"state_hash", "x", "x_mean"}),
              ElementsAre(HasSubstr("column \"state_hash\""), HasSubstr("column \"x_mean\"")));
}

TEST(RunsText, JoinsIndicesThatFollowEachOther) {
  const std::vector<std::size_t> runs{2, 3, 4, 7, 9, 10};
  EXPECT_EQ(runs_text(runs), "2 to 4, 7, 9 to 10");
  EXPECT_EQ(runs_text({}), "");
}

TEST_F(StudyFile, SaysWhatIsWrongAndWhere) {
  EXPECT_THAT(wrong(R"("parameters": [{"set": "/x", "value": [1]}])"),
              testing::Contains(HasSubstr("study.json:2: error: /parameters/0: missing \"values\"")));
  EXPECT_THAT(wrong(R"("parameters": [{"set": "/x", "from": 0, "to": 1}])"),
              ElementsAre(HasSubstr("study.json:2: error: /parameters/0: missing \"steps\"")));
  EXPECT_THAT(wrong(R"("parameters": [{"set": "x", "values": [1]}])"),
              ElementsAre(HasSubstr("expected a JSON pointer")));
  EXPECT_THAT(wrong(R"("parameters": [{"set": "/x", "values": []}])"),
              ElementsAre(HasSubstr("expected a list of 1 to")));
  EXPECT_THAT(wrong(R"("parameters": [{"set": "/x", "uniform": [2, 1]}], "samples": 2)"),
              ElementsAre(HasSubstr("must be below the second")));
  EXPECT_THAT(wrong(R"("parameters": [{"set": "/x", "log_uniform": [0, 1]}], "samples": 2)"),
              ElementsAre(HasSubstr("above 0")));
  EXPECT_THAT(wrong(R"("parameters": [{"set": "/x", "integers": [1.00000000001, 3]}], "samples": 2)"),
              ElementsAre(HasSubstr("found 1.00000000001 and 3")));
  EXPECT_THAT(wrong(R"("parameters": [{"set": "/x", "integers": [0.5, 1]}], "samples": 2)"),
              ElementsAre(HasSubstr("whole numbers")));
  EXPECT_THAT(
      wrong(R"("parameters": [{"set": "/x", "uniform": [1, 2]}])"),
      ElementsAre("study.json:2: error: /parameters/0: the values of \"x\" are random: give the number of "
                  "samples, as in \"samples\": 100"));
  EXPECT_THAT(wrong(R"("parameters": [{"set": "/x", "values": [1], "uniform": [1, 2]}])"),
              testing::Contains(HasSubstr("not both")));
  EXPECT_THAT(wrong(R"("parameters": [{"set": "/seed", "values": [1]}])"),
              ElementsAre(HasSubstr("the table of results already has a column \"seed\"")));
  EXPECT_THAT(
      wrong(R"("parameters": [{"set": "/x", "values": [1]}, {"set": "/y", "name": "x", "values": [2]}])"),
      ElementsAre(HasSubstr("/parameters/1: the table of results already has a column \"x\"")));
  EXPECT_THAT(
      wrong(R"("parameters": [{"set": "/x", "name": "a", "values": [1]},
    {"set": "/x", "name": "b", "values": [2]}])"),
      ElementsAre("study.json:2: error: /parameters/0: \"/x\" has no effect, because /parameters/1 sets the "
                  "same value: remove one of these two parameters"));
  EXPECT_THAT(wrong(R"("parameters": [{"set": "/x/-", "name": "a", "values": [1]},
    {"set": "/x/-", "name": "b", "values": [2]}])"),
              IsEmpty());
  EXPECT_THAT(wrong(R"("parameters": [{"set": "/x/0/n", "name": "a", "values": [1]},
    {"set": "/x/00", "name": "b", "values": [{"n": 2}]}])"),
              ElementsAre(HasSubstr("/parameters/0: \"/x/0/n\" has no effect, because /parameters/1 sets a "
                                    "value that contains it: remove one of these")));
  EXPECT_THAT(wrong(R"("parameters": [{"set": "/x/1", "name": "a", "values": [{}]},
    {"set": "/x/1/n", "name": "b", "values": [2]}, {"set": "/x/10", "name": "c", "values": [3]}])"),
              IsEmpty());
  constexpr const char* k_seed = R"("parameters": [{"set": "/seed", "name": "first", "values": [1]}])";
  EXPECT_THAT(wrong(k_seed), IsEmpty());
  EXPECT_THAT(
      wrong(std::string(k_seed) + R"(, "seeds": [5])"),
      ElementsAre("study.json:2: error: /parameters/0: \"/seed\" has no effect, because \"seeds\" sets the "
                  "seed of each run: remove this parameter or \"seeds\""));
  constexpr const char* k_end = R"("parameters": [{"set": "/quit_time_s", "values": [1]}])";
  EXPECT_THAT(wrong(k_end), IsEmpty());
  EXPECT_THAT(
      wrong(std::string(k_end) + R"(, "for_ms": 5)"),
      ElementsAre("study.json:2: error: /parameters/0: \"/quit_time_s\" has no effect, because \"for_s\" of "
                  "the study sets the end of each run: remove this parameter or \"for_s\""));
  EXPECT_THAT(wrong(R"("measures": ["fine"])"), IsEmpty());  // of a world that does not exist
  std::filesystem::create_directory(file_.parent_path() / "w");
  std::ofstream(file_.parent_path() / "w/hall.json")
      << R"({"troupe": 1, "measures": ["stalls", {"kind": "coverage", "name": "fine"}]})";
  EXPECT_EQ(study(R"("measures": ["fine", "stalls"])").measures,
            (std::vector<std::string>{"fine", "stalls"}));
  EXPECT_THAT(findings(diagnostics_), IsEmpty());
  EXPECT_THAT(wrong(R"("measures": ["coverag"])"), ElementsAre(HasSubstr("did you mean \"coverage\"?")));
  EXPECT_THAT(wrong(R"("measures": ["finer"])"),
              ElementsAre(testing::AllOf(
                  HasSubstr("study.json:2: error: /measures/0: unknown measure \"finer\"; known: alive, "),
                  testing::EndsWith("(did you mean \"fine\"?)"))));
  std::ofstream(file_.parent_path() / "w/hall.json") << R"({"troupe": 1,, "measures": ["stalls"]})";
  EXPECT_THAT(wrong(R"("measures": ["fine"])"), IsEmpty());  // the syntax error is reported with the world
  {
    Diagnostics found;
    load_study_text(file_, R"({"troupe_study": 1, "world": "hall.world", "measures": ["fine"]})",
                    make_registry(), found);
    EXPECT_THAT(findings(found), ElementsAre(HasSubstr("error: /measures/0: unknown measure \"fine\"")))
        << "Stage's syntax has no measures";
  }
  {
    Diagnostics found;
    load_study_text(file_, R"({"troupe_study": 1, "world": 3, "measures": ["fine"]})", make_registry(),
                    found);
    EXPECT_THAT(findings(found), ElementsAre(HasSubstr("error: /world: expected the path of a world file")));
  }
  EXPECT_THAT(wrong(R"("statistics": ["median"])"), ElementsAre(HasSubstr("known: last, max, mean, min")));
  EXPECT_THAT(wrong(R"("statistics": ["mean", "mean"])"), ElementsAre(HasSubstr("already contains")));
  EXPECT_THAT(wrong(R"("seeds": [])"), ElementsAre(HasSubstr("at least one seed")));
  EXPECT_THAT(wrong(R"("seeds": [9007199254740991])"), IsEmpty());
  EXPECT_THAT(
      wrong(R"("seeds": [9007199254740992])"),
      ElementsAre(
          "study.json:2: error: /seeds/0: must be from 0 to 9007199254740991, found 9007199254740992"));
  EXPECT_THAT(wrong(R"("seeds": {"from": 9007199254740990, "count": 2})"), IsEmpty());
  EXPECT_THAT(wrong(R"("seeds": {"from": 9007199254740990, "count": 3})"),
              ElementsAre("study.json:2: error: /seeds: the last seed would be 9007199254740992, but the "
                          "largest seed is 9007199254740991: reduce \"from\" or \"count\""));
  EXPECT_THAT(wrong(R"("parameters": [{"set": "/x", "integers": [1, 2147483648]}], "samples": 2)"),
              IsEmpty());
  EXPECT_THAT(wrong(R"("parameters": [{"set": "/x", "integers": [0, 2147483648]}], "samples": 2)"),
              ElementsAre(HasSubstr("that differ by at most 2^31 - 1, found 0 and 2147483648")));
  EXPECT_THAT(wrong(R"("seeds": 4)"), ElementsAre(HasSubstr("expected a list of seeds")));
  EXPECT_THAT(
      wrong(
          R"("seeds": {"from": 1, "count": 1000}, "parameters": [{"set": "/x", "from": 0, "to": 1, "steps": 1001}])"),
      ElementsAre(HasSubstr("the study has 1001000 runs; at most 1000000 are allowed")));
  EXPECT_THAT(wrong(R"("sample": 3)"), ElementsAre(HasSubstr("unknown key \"sample\"")));
  EXPECT_THAT(wrong(R"("measures": [], "statistics": [])"),
              ElementsAre("study.json:2: error: /measures: the list is empty: give at least one entry, or "
                          "remove the key, for the measures of the world",
                          HasSubstr("/statistics: the list is empty: give at least one entry")));
  std::ofstream(file_) << R"({"troupe_study": 1, "world": "w/hall.json\u0000.txt"})";
  Diagnostics nul;
  load_study(file_, make_registry(), nul);
  EXPECT_THAT(findings(nul), ElementsAre(HasSubstr("study.json:1: error: /world: the text contains the "
                                                   "character U+0000 (\\u0000): remove it")));
  Diagnostics nowhere;
  load_study("nowhere.json", make_registry(), nowhere);
  EXPECT_THAT(findings(nowhere), ElementsAre("nowhere.json: error: there is no such file"));
}

TEST_F(StudyFile, EqualRunsAreAnError) {
  EXPECT_THAT(
      wrong("\"seeds\": [1, 2,\n1]"),
      ElementsAre("study.json:3: error: /seeds/2: the list already contains this entry: remove one of "
                  "the two"));
  EXPECT_THAT(
      wrong("\"parameters\": [{\"set\": \"/x\", \"values\": [100000, \"a\",\n1e5, true, {}, 1,\n\"a\"]}]"),
      ElementsAre("study.json:3: error: /parameters/0/values/2: the list already contains this entry: "
                  "remove one of the two",
                  HasSubstr("study.json:4: error: /parameters/0/values/6: ")));
  EXPECT_THAT(wrong(R"("parameters": [{"set": "/x", "values": [0.5, "0.5", 0.25, [1], [2], "1", 1]}])"),
              IsEmpty());
  EXPECT_THAT(
      wrong(R"("parameters": [{"set": "/x", "from": 2, "to": 2, "steps": 3}])"),
      ElementsAre("study.json:2: error: /parameters/0: \"from\" and \"to\" are both 2, so 3 runs would "
                  "be equal: give different numbers, or one number as \"values\""));
  // The entries of a list that samples choose from may have weights.
  EXPECT_THAT(wrong(R"("parameters": [{"set": "/x", "values": ["a", "a", "b"]}], "samples": 9)"), IsEmpty());
  EXPECT_THAT(wrong(R"("samples": 9, "seeds": [3, 3])"), ElementsAre(HasSubstr("/seeds/1: ")));
}

}  // namespace
}  // namespace troupe::worldio::study_test
