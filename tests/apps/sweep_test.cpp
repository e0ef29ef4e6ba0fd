#include "apps/sweep/journal.hpp"
#include "tests/apps/program.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <sys/file.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <limits>

namespace {
int flock_error = 0;  // the error of flock() in this process; 0: the file system has locks
}  // namespace

/// Replaces the function of the C library, to test a file system without locks.
extern "C" int flock(int descriptor, int operation) noexcept {
  if (flock_error == 0) return static_cast<int>(syscall(SYS_flock, descriptor, operation));
  errno = flock_error;
  return -1;
}

namespace troupe::apps::sweep_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;

constexpr std::string_view k_world = R"({"troupe": 1, "bounds_m": [[-5, -5], [5, 5]],
  "types": {"bot": {"size_m": [0.3, 0.3, 0.3], "drive": {"kind": "diff"},
    "sensors": [{"name": "s", "kind": "ranger", "transducers": [{"range_max_m": 2, "fov_deg": 180, "samples": 9}]}],
    "controller": {"kind": "wander"}}},
  "populations": [{"name": "r", "type": "bot", "count": 3, "place": {"rule": "uniform", "region_m": [[-4, -4], [4, 4]]}}]})";

constexpr std::string_view k_study = R"({"troupe_study": 1, "world": "w.json", "for_s": 1,
  "parameters": [{"set": "/populations/0/count", "name": "robots", "values": [2, 5]}],
  "seeds": {"from": 1, "count": 3}, "measures": ["path_length", "stalls"], "statistics": ["last", "max"]})";

class Sweep : public ProgramTest {
 protected:
  Sweep() {
    write("w.json", k_world);
    write("study.json", k_study);
  }
  std::string table(const std::string& folder) { return read(folder + "/table.csv"); }
};

TEST_F(Sweep, MakesATableWithARowARun) {
  const Outcome outcome = troupe({"sweep", "study.json", "-o", "out"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "6 of 6 runs done: out/table.csv\n");
  const std::vector<std::string> lines = lines_of(table("out"));
  ASSERT_THAT(lines, SizeIs(7));
  EXPECT_EQ(lines[0],
            "run,robots,seed,ticks,time_s,path_length_m,path_length_m_max,stalls,stalls_max,stopped_by,state_"
            "hash,error");
  EXPECT_THAT(lines[1], StartsWith("0,2,1,10,1,"));
  EXPECT_THAT(lines[6], StartsWith("5,5,3,10,1,"));
  // A row is the run that `troupe run` makes.
  const Outcome run =
      troupe({"run", "w.json", "--for", "1", "--robots", "5", "--seed", "3", "--json", "--quiet"});
  const std::size_t hash = run.out.find("\"state_hash\":\"") + 14;
  EXPECT_THAT(lines[6], EndsWith("," + run.out.substr(hash, 16) + ","));
}

TEST_F(Sweep, RefusesColumnsOfTheSameNameBeforeTheRuns) {
  write("same.json", R"({"troupe_study": 1, "world": "w.json", "for_s": 1,
    "parameters": [{"set": "/populations/0/count", "name": "stalls", "values": [2, 5]}]})");
  const Outcome outcome = troupe({"sweep", "same.json", "-o", "out"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(
      outcome.err,
      "same.json:2: error: /parameters/0: the table of results already has a column \"stalls\", that of "
      "a measure: give this parameter another \"name\"\n");
  EXPECT_FALSE(std::filesystem::exists(path("out")));
}

TEST_F(Sweep, ErrorsOfParametersNameTheirPlaceInTheStudy) {
  write("wrong.json", R"({"troupe_study": 1, "world": "w.json", "for_s": 1, "parameters": [
    {"set": "/seed", "name": "s", "values": [1]},
    {"set": "/nix/0", "values": [1]}]})");
  const Outcome outcome = troupe({"sweep", "wrong.json", "-o", "out"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, StartsWith("wrong.json:3: error: /parameters/1: the world has no key \"nix\""));
}

TEST_F(Sweep, ErrorsOfMeasuresNameTheirPlaceInTheStudy) {
  write("wrong.json", R"({"troupe_study": 1, "world": "w.json", "for_s": 1, "measures": ["stalls",
    "stalls:missing"]})");
  const Outcome outcome = troupe({"sweep", "wrong.json", "-o", "out"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(
      outcome.err,
      StartsWith("wrong.json:2: error: /measures/1: unknown type or population of robots \"missing\""));
}

TEST_F(Sweep, GivesTheSameTableOnAnyThreadsAndInAnyParts) {
  ASSERT_EQ(troupe({"sweep", "study.json", "-o", "one", "--threads", "1"}).code, 0);
  ASSERT_EQ(troupe({"sweep", "study.json", "-o", "four", "--threads", "4"}).code, 0);
  EXPECT_EQ(table("four"), table("one"));
  const Outcome first = troupe({"sweep", "study.json", "-o", "parts", "--part", "2/2"});
  EXPECT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(first.out, "3 of 6 runs done; the table is written when all runs are done\n");
  EXPECT_EQ(troupe({"sweep", "study.json", "-o", "parts", "--part", "1/2"}).out,
            "6 of 6 runs done: parts/table.csv\n");
  EXPECT_EQ(table("parts"), table("one"));
}

/// The study, with every look.
std::string with_series() {
  std::string study(k_study);
  study.insert(1, R"("series": true, "measure_every_s": 0.3, )");
  return study;
}

TEST_F(Sweep, KeepsTheSeriesOfEachRun) {
  write("series.json", with_series());
  const Outcome outcome = troupe({"sweep", "series.json", "-o", "out"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "6 of 6 runs done: out/table.csv, out/series.csv\n");
  const std::vector<std::string> lines = lines_of(read("out/series.csv"));
  ASSERT_THAT(lines, SizeIs(1 + 6 * 5));  // at 0, 0.3, 0.6, 0.9 and 1 s
  EXPECT_EQ(lines[0], "run,time_s,path_length_m,stalls");
  EXPECT_EQ(lines[1], "0,0,0,0");
  EXPECT_THAT(lines[2], StartsWith("0,0.3,"));  // not 0.30000000000000004
  EXPECT_THAT(lines[5], StartsWith("0,1,"));
  EXPECT_THAT(lines[30], StartsWith("5,1,"));
  // The last look of a run is its row in the table.
  const std::string row = lines_of(table("out"))[6];
  EXPECT_THAT(row, HasSubstr("," + lines[30].substr(4, lines[30].rfind(',') - 4) + ","));
}

TEST_F(Sweep, TheSeriesIsTheSameOnAnyThreadsInAnyPartsAndAfterACut) {
  write("series.json", with_series());
  ASSERT_EQ(troupe({"sweep", "series.json", "-o", "one", "--threads", "1"}).code, 0);
  const std::string whole = read("one/series.csv");
  ASSERT_EQ(troupe({"sweep", "series.json", "-o", "parts", "--part", "2/2", "--threads", "4"}).code, 0);
  EXPECT_FALSE(std::filesystem::exists(path("parts/series.csv")));
  ASSERT_EQ(troupe({"sweep", "series.json", "-o", "parts", "--part", "1/2"}).code, 0);
  EXPECT_EQ(read("parts/series.csv"), whole);

  // Cut off behind a series and before its line in the journal; and with a series that is lost.
  const std::string journal = read("one/runs-1-of-1.jsonl");
  write("one/runs-1-of-1.jsonl", journal.substr(0, journal.size() * 2 / 3));
  std::filesystem::remove(path("one/series.csv"));
  std::filesystem::remove(path("one/series/0.csv"));
  EXPECT_EQ(troupe({"sweep", "series.json", "-o", "one"}).code, 0);
  EXPECT_EQ(read("one/series.csv"), whole);
}

TEST_F(Sweep, DamagedRowsOfARunAreMadeAgain) {
  write("series.json", with_series());
  ASSERT_EQ(troupe({"sweep", "series.json", "-o", "out"}).code, 0);
  const std::string whole = read("out/series.csv");
  const std::string rows = read("out/series/4.csv");
  const std::size_t last = rows.rfind('\n', rows.size() - 2) + 1;
  std::string other = rows;
  other.replace(last, 1, "3");
  for (const std::string& damaged : {std::string(), rows.substr(0, last), rows.substr(0, rows.size() - 1),
                                     std::string(rows.size(), '\0'), other}) {
    write("out/series/4.csv", damaged);
    std::filesystem::remove(path("out/series.csv"));
    EXPECT_EQ(troupe({"sweep", "series.json", "-o", "out"}).code, 0);
    EXPECT_EQ(read("out/series.csv"), whole);
  }
}

// Earlier versions did not round them.
TEST_F(Sweep, TimesAreRoundedAlsoInRowsOfEarlierVersions) {
  std::string study = with_series();
  study.replace(study.find("\"for_s\": 1"), 10, "\"for_s\": 0.3");
  write("series.json", study);
  ASSERT_EQ(troupe({"sweep", "series.json", "-o", "out"}).code, 0);
  EXPECT_THAT(lines_of(table("out"))[1], StartsWith("0,2,1,3,0.3,"));
  const std::string whole = read("out/series.csv");
  const std::string journal = read("out/runs-1-of-1.jsonl");
  std::string rows = read("out/series/0.csv");
  write("out/series/0.csv", rows.replace(rows.find("0,0.3,"), 6, "0,0.30000000000000004,"));
  std::filesystem::remove(path("out/series.csv"));
  EXPECT_EQ(troupe({"sweep", "series.json", "-o", "out"}).code, 0);
  EXPECT_EQ(read("out/series.csv"), whole);
  EXPECT_EQ(read("out/runs-1-of-1.jsonl"), journal);  // no run was made again
}

/// What the python3 that the program starts is handed.
constexpr std::string_view k_fake_python = R"(#!/bin/sh
test "$1" = -c || exit 9
shift 2
echo "$@"
exit 7
)";

TEST_F(Sweep, PlotHandsOverToPython) {
  write("python", k_fake_python);
  std::filesystem::permissions(path("python"), std::filesystem::perms::owner_all);
  setenv("TROUPE_PYTHON", path("python").c_str(), 1);
  const Outcome outcome =
      troupe({"plot", "out", "--measure", "order", "--over", "speed", "--by", "robots,seed", "-o", "o.pdf"});
  const Outcome logarithmic = troupe({"plot", "--log-y", "--log-x", "out"});
  const Outcome one_line = troupe({"plot", "out", "--by", "", "--bars", "interval"});
  const Outcome alone = troupe({"plot", "--", "-odd"});
  setenv("TROUPE_PYTHON", "./no-such-python", 1);
  const Outcome missing = troupe({"plot", "out"});
  unsetenv("TROUPE_PYTHON");
  EXPECT_EQ(outcome.code, 7);
  EXPECT_EQ(outcome.out, "--measure=order --over=speed --by=robots,seed --out=o.pdf -- out\n");
  EXPECT_EQ(logarithmic.out, "--log-x --log-y -- out\n");
  EXPECT_EQ(one_line.out, "--by= --bars=interval -- out\n");
  EXPECT_EQ(alone.out, "-- -odd\n");
  EXPECT_EQ(missing.code, 1);
  EXPECT_THAT(lines_of(missing.err),
              ElementsAre(AllOf(StartsWith("troupe plot: error: ./no-such-python cannot be started"),
                                HasSubstr("apt install python3-matplotlib; the environment variable "
                                          "TROUPE_PYTHON can name another Python interpreter)"))));
  EXPECT_EQ(troupe({"plot"}).code, 2);
  EXPECT_EQ(troupe({"plot", "out", "--measure", ""}).code, 2);
}

TEST_F(Sweep, GoesOnWhereItWasCutOff) {
  ASSERT_EQ(troupe({"sweep", "study.json", "-o", "out", "--threads", "1"}).code, 0);
  const std::string whole = table("out");
  const std::string journal = read("out/runs-1-of-1.jsonl");
  write("out/runs-1-of-1.jsonl", journal.substr(0, journal.size() * 2 / 3));  // in the middle of a line
  std::filesystem::remove(path("out/table.csv"));
  EXPECT_EQ(troupe({"sweep", "study.json", "-o", "out"}).code, 0);
  EXPECT_EQ(table("out"), whole);
}

TEST_F(Sweep, DoesNotMixStudies) {
  ASSERT_EQ(troupe({"sweep", "study.json", "-o", "out"}).code, 0);
  const std::string before = table("out");
  std::string other(k_world);
  other.replace(other.find("0.3, 0.3"), 3, "0.4");
  write("w.json", other);
  const Outcome outcome = troupe({"sweep", "study.json", "-o", "out"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(
      outcome.err,
      "out/runs-1-of-1.jsonl: error: the folder contains runs with another world: choose another folder with "
      "-o\n");
  EXPECT_EQ(table("out"), before);
  write("w.json", k_world);
  write("study.json", std::string(k_study) + "\n");
  EXPECT_THAT(troupe({"sweep", "study.json", "-o", "out"}).err, HasSubstr(" runs with another study file: "));
}

TEST_F(Sweep, ResultsTellWhatTheyDependOn) {
  ASSERT_EQ(troupe({"sweep", "study.json", "-o", "out"}).code, 0);
  const std::string header =
      "written by         troupe [0-9].*\n.*study_file         [0-9a-f]{16}\n.*world              "
      "[0-9a-f]{16}";
  EXPECT_THAT(troupe({"info", "out/runs-1-of-1.jsonl"}).out, testing::ContainsRegex(header));
  if (!worldio::has_hdf5()) GTEST_SKIP() << "no HDF5";
  EXPECT_THAT(troupe({"info", "out/table.h5"}).out, testing::ContainsRegex(header));
}

TEST_F(Sweep, ReplacesOnlyItsOwnTables) {
  write("series.json", with_series());
  std::filesystem::create_directories(path("out"));
  const auto refused = [&](const std::string& name, const std::string& text) {
    write(name, text);
    const Outcome outcome = troupe({"sweep", "series.json", "-o", "out"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.err,
              name +
                  ": error: cannot be written: the file exists and is not a table of results (troupe "
                  "sweep): choose another folder with -o, or remove the file\n");
    EXPECT_EQ(read(name), text);
    EXPECT_FALSE(std::filesystem::exists(path("out/runs-1-of-1.jsonl")));
    std::filesystem::remove(path(name));
  };
  refused("out/table.csv", "robots,coverage\n2,0.5\n");
  refused("out/table.csv", "run,coverage\n2,0.5\n");
  refused("out/series.csv", "time,coverage\n0,0.5\n");
  if (worldio::has_hdf5()) {
    refused("out/table.h5", "my data, in another format\n");
    worldio::Hdf5File::create(path("other.h5")).create_group("table");  // as pandas writes it
    refused("out/table.h5", read("other.h5"));
    write("out/table.h5", read("other.h5").substr(0, 100));
    const Outcome damaged = troupe({"sweep", "series.json", "-o", "out"});
    EXPECT_EQ(damaged.code, 2);
    EXPECT_THAT(damaged.err, StartsWith("out/table.h5: error: "));
    std::filesystem::remove(path("out/table.h5"));
  }
  ASSERT_EQ(troupe({"sweep", "series.json", "-o", "out"}).code, 0);
  EXPECT_EQ(troupe({"sweep", "series.json", "-o", "out"}).code, 0);  // replaces the tables
}

TEST_F(Sweep, ReplacesATableWithALineBreakInTheNameOfAColumn) {
  std::string study(k_study);
  study.replace(study.find("\"robots\""), 8, R"("number\nof robots")");
  write("study.json", study);
  ASSERT_EQ(troupe({"sweep", "study.json", "-o", "out"}).code, 0);
  EXPECT_THAT(table("out"), StartsWith("run,\"number\nof robots\",seed,ticks,time_s,"));
  const Outcome again = troupe({"sweep", "study.json", "-o", "out"});
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(troupe({"info", "out/table.csv"}).out, HasSubstr("table of the results of a sweep"));
}

/// The world of the studies, with walls that the image a.pgm shows.
std::string world_with_image() {
  std::string world(k_world);
  world.replace(world.find("\"bounds_m\""), 10,
                R"("floorplans": [{"name": "walls", "bitmap": "a.pgm", "size_m": [12, 12, 1]}], "bounds_m")");
  return world;
}

// Run 0 does not read the file that has changed.
TEST_F(Sweep, DoesNotMixStudiesOfWhichAChosenFileHasChanged) {
  write("a.pgm", "P5 4 1 255\n" + std::string("\0\xff\xff\0", 4));
  write("b.pgm", "P5 4 1 255\n" + std::string("\0\xff\xff\0", 4));
  write("w.json", world_with_image());
  write("study.json", R"({"troupe_study": 1, "world": "w.json", "for_s": 1,
    "parameters": [{"set": "/floorplans/0/bitmap", "name": "image", "values": ["a.pgm", "b.pgm"]}]})");
  const Outcome made = troupe({"sweep", "study.json", "-o", "out"});
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_EQ(troupe({"sweep", "study.json", "-o", "out"}).code, 0);
  write("b.pgm", "P5 6 1 255\n" + std::string("\0\xff\xff\xff\xff\0", 6));
  EXPECT_THAT(troupe({"sweep", "study.json", "-o", "out"}).err,
              HasSubstr("the folder contains runs with another world: "));
}

// The image that has changed fits only in the world of its own run: it has no room for the robots of run 0.
TEST_F(Sweep, DoesNotMixStudiesOfWhichAFileChosenTogetherWithAnotherValueHasChanged) {
  write("a.pgm", "P5 4 1 255\n" + std::string("\0\xff\xff\0", 4));
  write("b.pgm", "P5 4 1 255\n" + std::string("\0\0\0\0", 4));
  write("w.json", world_with_image());
  write("study.json",
        R"({"troupe_study": 1, "world": "w.json", "for_s": 1, "measures": ["stalls"], "parameters": [
    {"set": "/floorplans/0/bitmap", "name": "image", "values": ["a.pgm", "b.pgm"]},
    {"set": "/populations/0/count", "name": "robots", "values": [2, 0], "with": "image"}]})");
  ASSERT_EQ(troupe({"run", "w.json", "--for", "1", "--set", "/floorplans/0/bitmap=b.pgm", "--quiet"}).code,
            2);
  const Outcome made = troupe({"sweep", "study.json", "-o", "out"});
  ASSERT_EQ(made.code, 0) << made.err;
  const std::string whole = table("out");
  const std::vector<std::string> lines = lines_of(whole);
  ASSERT_THAT(lines, SizeIs(3));
  EXPECT_THAT(lines[0], StartsWith("run,image,robots,seed,"));
  EXPECT_THAT(lines[1], StartsWith("0,a.pgm,2,"));
  EXPECT_THAT(lines[2], StartsWith("1,b.pgm,0,"));
  EXPECT_EQ(troupe({"sweep", "study.json", "-o", "out"}).code, 0);
  EXPECT_EQ(table("out"), whole);
  write("b.pgm", "P5 4 1 255\n" + std::string("\0\xff\0\0", 4));
  EXPECT_THAT(troupe({"sweep", "study.json", "-o", "out"}).err,
              HasSubstr("the folder contains runs with another world: "));
}

// If the journals were removed by hand, another study can write its tables into the folder.
TEST_F(Sweep, RemovesTheSeriesOfAnEarlierStudyThatIsNotReplaced) {
  write("series.json", with_series());
  ASSERT_EQ(troupe({"sweep", "series.json", "-o", "out"}).code, 0);
  std::filesystem::remove(path("out/runs-1-of-1.jsonl"));
  ASSERT_EQ(troupe({"sweep", "study.json", "-o", "out"}).code, 0);
  EXPECT_FALSE(std::filesystem::exists(path("out/series.csv")));
  std::filesystem::remove(path("out/runs-1-of-1.jsonl"));
  write("out/series.csv", "time,coverage\n");
  ASSERT_EQ(troupe({"sweep", "study.json", "-o", "out"}).code, 0);
  EXPECT_EQ(read("out/series.csv"), "time,coverage\n") << "another program wrote it";
}

TEST_F(Sweep, ARunThatCannotBeMadeIsARowThatSaysWhy) {
  std::string study(k_study);
  study.replace(study.find("[2, 5]"), 6, "[2, 5000]");  // there is no room for them
  write("study.json", study);
  const Outcome outcome = troupe({"sweep", "study.json", "-o", "out"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.out, "3 of 6 runs done, 3 failed: out/table.csv\n");
  EXPECT_THAT(outcome.err, HasSubstr("run 3: "));
  const std::vector<std::string> lines = lines_of(table("out"));
  ASSERT_THAT(lines, SizeIs(7));
  EXPECT_THAT(lines[4], AllOf(StartsWith("3,5000,1,0,nan,nan,nan,nan,nan,,,"), HasSubstr("placed")));
}

TEST_F(Sweep, AFailedRunWithoutSeedsHasTheSeedOfTheWorld) {
  std::string world(k_world);
  write("w.json", world.insert(1, R"("seed": 7, )"));
  write("study.json", R"({"troupe_study": 1, "world": "w.json", "for_s": 1, "measures": ["stalls"],
    "parameters": [{"set": "/populations/0/count", "name": "robots", "values": [2, 5000]}]})");
  EXPECT_EQ(troupe({"sweep", "study.json", "-o", "out"}).code, 1);
  const std::vector<std::string> lines = lines_of(table("out"));
  ASSERT_THAT(lines, SizeIs(3));
  EXPECT_THAT(lines[1], StartsWith("0,2,7,10,1,"));
  EXPECT_THAT(lines[2], StartsWith("1,5000,7,0,nan,nan,,,"));
  if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
  EXPECT_THAT(
      worldio::Hdf5File::open(path("out/table.h5")).group("table").dataset("seed").read<std::uint64_t>(),
      ElementsAre(7, 7));
}

TEST_F(Sweep, AFailedRunHasTheSeedOfItsParameter) {
  write("study.json", R"({"troupe_study": 1, "world": "w.json", "for_s": 1, "measures": ["stalls"],
    "parameters": [{"set": "/seed", "name": "first", "values": [9, -1]},
                   {"set": "/populations/0/count", "name": "robots", "values": [2, 5000]}]})");
  EXPECT_EQ(troupe({"sweep", "study.json", "-o", "out"}).code, 1);
  const std::vector<std::string> lines = lines_of(table("out"));
  ASSERT_THAT(lines, SizeIs(5));
  EXPECT_THAT(lines[1], StartsWith("0,9,2,9,10,1,"));
  EXPECT_THAT(lines[2], StartsWith("1,9,5000,9,0,nan,nan,,,"));
  EXPECT_THAT(lines[3], StartsWith("2,-1,2,nan,0,nan,nan,,,"));
}

TEST_F(Sweep, LargeWholeNumbersAreNotRounded) {
  const auto columns = [&](const std::string& values) {
    write("study.json", R"({"troupe_study": 1, "world": "w.json", "for_s": 1, "measures": ["stalls"],
      "parameters": [{"set": "/seed", "name": "first", "values": [)" +
                            values + "]}]}");
    std::filesystem::remove_all(path("out"));
    EXPECT_EQ(troupe({"sweep", "study.json", "-o", "out"}).code, 0);
    return lines_of(table("out"));
  };
  std::vector<std::string> lines = columns("18446744073709551615, 9007199254740993");
  ASSERT_THAT(lines, SizeIs(3));
  EXPECT_THAT(lines[1], StartsWith("0,18446744073709551615,18446744073709551615,10,"));
  EXPECT_THAT(lines[2], StartsWith("1,9007199254740993,9007199254740993,10,"));
  if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
  EXPECT_THAT(
      worldio::Hdf5File::open(path("out/table.h5")).group("table").dataset("first").read<std::uint64_t>(),
      ElementsAre(18446744073709551615u, 9007199254740993u));
  lines = columns("7, 9007199254740992");
  EXPECT_THAT(lines[2], StartsWith("1,9007199254740992,9007199254740992,10,"));
  EXPECT_THAT(worldio::Hdf5File::open(path("out/table.h5")).group("table").dataset("first").read<double>(),
              ElementsAre(7, 9007199254740992.0));
}

TEST_F(Sweep, AnErrorOfSeveralRunsIsPrintedOnce) {
  std::string world(k_world);
  world.replace(world.find("[[-4, -4], [4, 4]]"), 18, "[[0, 0], [0.1, 0.1]]");  // there is room for one robot
  write("w.json", world);
  std::string study(k_study);
  study.replace(study.find("[2, 5]"), 6, "[2, 1, 5]");
  write("study.json", study);
  const Outcome outcome = troupe({"sweep", "study.json", "-o", "out"});
  EXPECT_EQ(outcome.code, 1);
  const std::vector<std::string> lines = lines_of(outcome.err);
  ASSERT_THAT(lines, SizeIs(2)) << outcome.err;
  EXPECT_THAT(lines[0], AllOf(StartsWith("runs 0 to 2: "), HasSubstr("placed 1 of 2 bodies")));
  EXPECT_THAT(lines[1], AllOf(StartsWith("runs 6 to 8: "), HasSubstr("placed 1 of 5 bodies")));
}

TEST_F(Sweep, FailedRunsOfAllPartsAreInTheTable) {
  std::string study(k_study);
  study.replace(study.find("[2, 5]"), 6, "[2, 5000]");
  write("study.json", study);
  ASSERT_EQ(troupe({"sweep", "study.json", "-o", "whole"}).code, 1);
  EXPECT_EQ(troupe({"sweep", "study.json", "-o", "parts", "--part", "2/2"}).out,
            "1 of 6 runs done, 2 failed; the table is written when all runs are done\n");
  EXPECT_EQ(troupe({"sweep", "study.json", "-o", "parts", "--part", "1/2"}).out,
            "3 of 6 runs done, 3 failed: parts/table.csv\n");
  EXPECT_EQ(table("parts"), table("whole"));
  // A repeated call makes the failed runs again, and its exit code is about the runs that it makes.
  EXPECT_THAT(troupe({"sweep", "study.json", "-o", "parts"}).err,
              AllOf(HasSubstr("run 3: "), HasSubstr("run 4: "), HasSubstr("run 5: ")));
  EXPECT_EQ(troupe({"sweep", "study.json", "-o", "parts", "--part", "1/6"}).code, 0);
}

TEST_F(Sweep, TheFirstRunMayFail) {
  std::string study(k_study);
  study.replace(study.find("[2, 5]"), 6, "[5000, 2]");
  write("study.json", study);
  const Outcome outcome = troupe({"sweep", "study.json", "-o", "out"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.out, "3 of 6 runs done, 3 failed: out/table.csv\n");
  EXPECT_THAT(outcome.err, StartsWith("run 0: "));
}

TEST_F(Sweep, UsualMeasuresThatAWorldCannotHaveAreLeftOut) {
  write("study.json", R"({"troupe_study": 1, "world": "w.json", "for_s": 1,
    "parameters": [{"set": "/bounds_m", "name": "bounds",
                    "values": [[[-5, -5], [5, 5]], [[-5000, -5000], [5000, 5000]]]}]})");
  ASSERT_EQ(troupe({"sweep", "study.json", "-o", "out"}).code, 0);
  const std::vector<std::string> lines = lines_of(table("out"));
  ASSERT_THAT(lines, SizeIs(3));
  EXPECT_THAT(lines[0], HasSubstr(",coverage,"));
  EXPECT_THAT(lines[1], Not(HasSubstr("nan")));
  EXPECT_THAT(lines[2], HasSubstr(",nan,"));
}

TEST_F(Sweep, APopulationMayBeEmptyInARun) {
  std::string world(k_world);
  write("w.json", world.insert(1, R"("stop_when": ["stalls:r > 90"],
    "at": [{"time_s": 0.5, "remove": {"population": "r", "count": 1}}], )"));
  write("study.json", R"({"troupe_study": 1, "world": "w.json", "for_s": 1, "measures": ["alive:r"],
    "parameters": [{"set": "/populations/0/count", "name": "robots", "values": [0, 1, 4]}]})");
  const Outcome outcome = troupe({"sweep", "study.json", "-o", "out"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(lines_of(table("out")), ElementsAre(StartsWith("run,"), StartsWith("0,0,1,10,1,0,"),
                                                  StartsWith("1,1,1,10,1,0,"), StartsWith("2,4,1,10,1,3,")));
  if (worldio::has_hdf5()) {
    EXPECT_EQ(troupe({"run", "w.json", "--robots", "0", "--for", "0.2", "--checkpoint", "c.h5"}).code, 0);
    EXPECT_EQ(troupe({"resume", "c.h5", "--for", "1"}).code, 0);
  }
  EXPECT_EQ(troupe({"convert", "w.json", "v.json", "--set", "/populations/0/count=0"}).code, 0);
  EXPECT_EQ(troupe({"run", "v.json", "--for", "1"}).code, 0);
}

TEST_F(Sweep, ARunEndsWhereTheWorldSays) {
  std::string world(k_world);
  write("w.json", world.insert(1, R"("stop_when": ["path_length >= 0.05"], )"));
  ASSERT_EQ(troupe({"sweep", "study.json", "-o", "out"}).code, 0);
  const std::vector<std::string> lines = lines_of(table("out"));
  ASSERT_THAT(lines, SizeIs(7));
  for (const std::string& line : std::vector(lines.begin() + 1, lines.end())) {
    EXPECT_THAT(line, HasSubstr(",path_length >= 0.05,"));
    EXPECT_THAT(line, Not(HasSubstr(",10,1,")));
  }
}

TEST_F(Sweep, ADamagedJournalIsAnError) {
  ASSERT_EQ(troupe({"sweep", "study.json", "-o", "out", "--threads", "1"}).code, 0);
  const std::string journal = read("out/runs-1-of-1.jsonl");
  const std::size_t values = journal.find("\"values\":[");
  ASSERT_NE(values, journal.npos);
  std::string without_values = journal;
  without_values.erase(values + 10, journal.find(']', values) - values - 10);
  std::string unknown_run = journal;
  unknown_run.replace(unknown_run.find("\"run\":0"), 7, "\"run\":6");
  std::string word = journal;
  word.replace(values + 10, 1, "\"a\",1");
  for (const std::string& damaged : {without_values, unknown_run, word}) {
    write("out/runs-1-of-1.jsonl", damaged);
    const Outcome outcome = troupe({"sweep", "study.json", "-o", "out"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, StartsWith("out/runs-1-of-1.jsonl:2: error: not a result that troupe sweep "
                                        "writes: the file is damaged; remove it"));
  }
}

TEST_F(Sweep, JournalsKeepValuesThatAreNotFinite) {
  constexpr double k_infinity = std::numeric_limits<double>::infinity();
  constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
  SweepJournal(journal_file(path("."), 1, 1), "the study")
      .add({.run = 0, .values = {k_infinity, -k_infinity, k_nan, 0.1}});
  const auto values = [&] {
    return read_journals(path("."), "the study", {.runs = 1, .values = 4}).outcomes.at(0).values;
  };
  EXPECT_THAT(values(), ElementsAre(k_infinity, -k_infinity, ::testing::IsNan(), 0.1));
  std::string journal = read("runs-1-of-1.jsonl");  // an earlier version wrote null for NaN
  journal.replace(journal.find("\"nan\""), 5, "null");
  write("runs-1-of-1.jsonl", journal);
  EXPECT_THAT(values(), ElementsAre(k_infinity, -k_infinity, ::testing::IsNan(), 0.1));
}

TEST_F(Sweep, AResultThatCannotBeWrittenLeavesNoPartOfALine) {
  const std::filesystem::path file = journal_file(path("."), 1, 1);
  SweepJournal journal(file, "the study");
  journal.add({.run = 0});
  const std::string before = read("runs-1-of-1.jsonl");
  rlimit usual{};
  getrlimit(RLIMIT_FSIZE, &usual);
  rlimit full_disk = usual;
  full_disk.rlim_cur = before.size() + 10;  // a part of the line fits
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &full_disk);
  std::string error;
  try {
    journal.add({.run = 1});
  } catch (const std::runtime_error& thrown) {
    error = thrown.what();
  }
  setrlimit(RLIMIT_FSIZE, &usual);
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(error,
              EndsWith("runs-1-of-1.jsonl: error: the result of run 1 cannot be written: File too large"));
  EXPECT_EQ(read("runs-1-of-1.jsonl"), before);
  journal.add({.run = 2});
  const SweepResults results = read_journals(path("."), "the study", {.runs = 3, .values = 0});
  EXPECT_THAT(results.outcomes, SizeIs(2));
  EXPECT_TRUE(results.outcomes.contains(2));
}

TEST_F(Sweep, AFullDiskEndsTheSweepWhichCanBeContinued) {
  ASSERT_EQ(troupe({"sweep", "study.json", "-o", "whole"}).code, 0);
  const std::vector<std::string> lines = lines_of(read("whole/runs-1-of-1.jsonl"));
  const std::size_t fits = lines[0].size() + 3 * lines[1].size();
  const Outcome full = troupe_with_file_limit({"sweep", "study.json", "-o", "out", "--threads", "3"}, fits);
  EXPECT_EQ(full.code, 1);
  EXPECT_THAT(full.err, HasSubstr(" cannot be written: File too large"));
  EXPECT_THAT(read("out/runs-1-of-1.jsonl"), EndsWith("}\n"));
  EXPECT_EQ(troupe({"sweep", "study.json", "-o", "out"}).code, 0);
  EXPECT_EQ(table("out"), table("whole"));
}

TEST_F(Sweep, OnlyALockOfAnotherProcessIsAnError) {
  const std::filesystem::path file = journal_file(path("."), 1, 1);
  const SweepJournal journal(file, "the study");
  const auto open_again = [&] { const SweepJournal again(file, "the study"); };
  EXPECT_THAT(open_again, ::testing::ThrowsMessage<std::runtime_error>(
                              HasSubstr("another process is running this part of the study")));
  for (const int error : {ENOSYS, EOPNOTSUPP, ENOLCK}) {
    flock_error = error;
    EXPECT_NO_THROW(open_again());
    flock_error = 0;
  }
}

TEST_F(Sweep, AJournalThatCannotBeReadIsAnError) {
  std::filesystem::create_directories(path("out/runs-2-of-2.jsonl"));  // reading a folder fails
  const Outcome outcome = troupe({"sweep", "study.json", "-o", "out"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, StartsWith("out/runs-2-of-2.jsonl: error: cannot be read: "));
}

TEST_F(Sweep, LongErrorsAreCutInHdf5) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
  std::string long_name;
  for (int i = 0; i < 150; ++i) long_name += "\u00e4";  // two bytes
  write("study.json", R"({"troupe_study": 1, "world": "w.json", "for_s": 1, "measures": ["stalls"],
    "parameters": [{"set": "/types/bot/controller/kind", "name": "kind", "values": ["wander", ")" +
                          long_name + R"("]}]})");
  ASSERT_EQ(troupe({"sweep", "study.json", "-o", "out"}).code, 1);
  EXPECT_THAT(lines_of(table("out"))[2], HasSubstr("unknown controller \"\"" + long_name + "\"\"; known: "));
  const worldio::Hdf5File file = worldio::Hdf5File::open(path("out/table.h5"));
  const std::vector<std::string> errors = file.group("table").read_texts("error");
  EXPECT_EQ(errors[0], "");
  EXPECT_THAT(errors[1], EndsWith("\u00e4..."));
  EXPECT_LE(errors[1].size(), 200u);
}

TEST_F(Sweep, MayNameMeasuresOfTheWorld) {
  std::string world(k_world);
  world.insert(
      1, R"("measures": [{"kind": "share_within", "center_m": [0, 0], "radius_m": 9, "name": "in_nest"}], )");
  write("w.json", world);
  write("study.json", R"({"troupe_study": 1, "world": "w.json", "for_s": 0.2, "measures": ["in_nest"]})");
  const Outcome outcome = troupe({"sweep", "study.json", "-o", "out"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(lines_of(table("out"))[0], HasSubstr(",in_nest"));
}

TEST_F(Sweep, ListsTheRunsAndMakesNone) {
  const Outcome outcome = troupe({"sweep", "study.json", "--list"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(lines_of(outcome.out),
              ElementsAre("run,robots,seed", "0,2,1", "1,2,2", "2,2,3", "3,5,1", "4,5,2", "5,5,3"));
  write("study.json", R"({"troupe_study": 1, "world": "w.json", "for_s": 1, "parameters": [
    {"set": "/populations/0/place/region_m", "name": "a,b", "values": [[[-4, -4], [4, 4]]]},
    {"set": "/types/bot/controller/kind", "name": "kind", "values": ["wander"]}]})");
  EXPECT_THAT(lines_of(troupe({"sweep", "study.json", "--list"}).out),
              ElementsAre("run,\"a,b\",kind,seed", "0,\"[[-4, -4], [4, 4]]\",wander,world's"));
  EXPECT_THAT(files(), ElementsAre("study.json", "w.json"));
}

TEST_F(Sweep, WhatIsWrongIsToldBeforeAnythingIsWritten) {
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& message) {
    const Outcome outcome = troupe(arguments);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_THAT(outcome.err, HasSubstr(message));
    EXPECT_THAT(files(), ElementsAre("study.json", "w.json"));
  };
  refused({"sweep", "study.json"}, "-o DIR is required");
  refused({"sweep", "study.json", "-o", "out", "--part", "3/2"}, "\"3/2\" is not a part I/N");
  refused({"sweep", "w.json", "-o", "out"},
          "w.json:1: error: this is a world, not a study: a study names it with the key \"world\"\n");
  refused({"run", "study.json", "--for", "1"},
          "study.json:1: error: this is a study, not a world: `troupe sweep` makes its runs\n");
  std::string study(k_study);
  study.replace(study.find("/populations/0/count"), 20, "/populations/7/count");
  write("study.json", study);
  refused({"sweep", "study.json", "-o", "out"},
          "study.json:2: error: /parameters/0: /populations is a list of length 1");
  study = k_study;
  study.insert(1, R"("series": "yes", )");
  write("study.json", study);
  refused({"sweep", "study.json", "-o", "out"}, "study.json:1: error: /series: ");
  study = k_study;
  study.replace(study.find("\"for_s\": 1,"), 11, "");
  write("study.json", study);
  refused({"sweep", "study.json", "-o", "out"}, "error: no end time: give \"for_s\" in the study");
  write("study.json",
        "{\"troupe_study\": 1,\n\"world\": \"wurld.json\", \"for_s\": 1, \"measures\": [\"in_nest\"]}");
  const std::string missing = "study.json:2: error: /world: wurld.json: there is no such file\n";
  refused({"sweep", "study.json", "-o", "out"}, missing);
  EXPECT_EQ(troupe({"sweep", "study.json", "-o", "out"}).err, missing);
}

}  // namespace
}  // namespace troupe::apps::sweep_test
