#include "tests/apps/program.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace troupe::apps::diff_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::StartsWith;

/// A log's header, with one text replaced by another; 9 lines.
std::string header(const std::string& what = "", const std::string& by = "") {
  std::string text =
      "# troupe hash log 1\n"
      "# version: troupe 0.1.0 (GNU 12.2.0; Release -O3; x86_64; assertions off)\n"
      "# world: worlds/room.json\n# seed: 1\n# tick_s: 0.1\n# ranging: exact\n# robots: 12\n"
      "# threads: 2\n# tile_m: 4\n";
  if (!what.empty()) text.replace(text.find(what), what.size(), by);
  return text;
}

std::string line(std::uint64_t tick, std::uint64_t sensor = 3, std::uint64_t memory = 4) {
  return fmt::format("{} {:016x} pose={:016x} velocity={:016x} sensor={:016x} memory={:016x}\n", tick,
                     tick + 2 + sensor + memory, tick, 2, sensor, memory);
}

std::string lines(std::uint64_t first, std::uint64_t last) {
  std::string text;
  for (std::uint64_t tick = first; tick <= last; ++tick) text += line(tick);
  return text;
}

class Diff : public ProgramTest {
 protected:
  Outcome diff(const std::string& a, const std::string& b, std::vector<std::string> options = {}) {
    write("a.log", a);
    write("b.log", b);
    options.insert(options.begin(), {"diff", "a.log", "b.log"});
    return troupe(options);
  }
  /// The error that a second log meets.
  std::string error_of(const std::string& b) {
    const Outcome outcome = diff(header() + lines(0, 3), b);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.out, IsEmpty());
    return outcome.err;
  }
};

TEST_F(Diff, SameBits) {
  const Outcome outcome =
      diff(header() + lines(0, 10), header("# threads: 2", "# threads: 8") + lines(0, 10));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "same bits, tick 0 to 10; the last state has the hash 0000000000000013\n");
}

TEST_F(Diff, LogsMayHaveLineEndsOfOtherSystems) {
  std::string log;
  for (const char c : header() + lines(0, 10)) log += c == '\n' ? "\r\n" : std::string(1, c);
  const Outcome outcome = diff(header() + lines(0, 10), log);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, StartsWith("same bits, tick 0 to 10"));
}

TEST_F(Diff, FindsTheFirstTickAndItsGroups) {
  const Outcome outcome =
      diff(header() + lines(0, 10), header() + lines(0, 6) + line(7, 30, 40) + line(8, 9, 9) + lines(9, 10));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(lines_of(outcome.out), ElementsAre("differs at tick 7, in sensor, memory:",
                                                 StartsWith("  a.log:17: 7 0000000000000010 pose="),
                                                 StartsWith("  b.log:17: 7 000000000000004f pose=")));
}

TEST_F(Diff, GroupsThatAddUpToTheSameStateDifferAllTheSame) {
  const Outcome outcome = diff(header() + lines(0, 1), header() + line(0) + line(1, 4, 3));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.out, StartsWith("differs at tick 1, in sensor, memory:"));
}

TEST_F(Diff, ALogThatEndsEarlierDiffers) {
  const Outcome outcome = diff(header() + lines(0, 10), header() + lines(0, 7));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.out,
            "differs in length: b.log ends at tick 7, but a.log continues; same bits from tick 0 until "
            "then\n");
}

TEST_F(Diff, ALogMayBeginLater) {
  EXPECT_EQ(diff(header() + lines(0, 10), header() + lines(5, 10)).out,
            "same bits, tick 5 to 10; the last state has the hash 0000000000000013\n");
  const Outcome apart = diff(header() + lines(0, 3), header() + lines(5, 10));
  EXPECT_EQ(apart.code, 2);
  EXPECT_EQ(
      apart.err,
      "a.log: error: the log ends before tick 5, at which b.log begins: the logs have no tick in common\n");
}

TEST_F(Diff, OtherDomainsAreComparedOnlyWhenToldTo) {
  const std::string clang = header("GNU 12.2.0; Release -O3", "Clang 14.0.6; Debug -Og") + lines(0, 3);
  EXPECT_EQ(error_of(clang),
            "b.log:2: error: compiler is \"Clang 14.0.6\", but \"GNU 12.2.0\" in a.log: the results may "
            "differ; --across-domains compares the files anyway\nb.log:2: error: flags is \"Debug -Og\", but "
            "\"Release -O3\" in a.log: the results may differ; --across-domains compares the files anyway\n");
  EXPECT_THAT(error_of(header("x86_64", "aarch64") + lines(0, 3)),
              HasSubstr("instruction set is \"aarch64\""));
  EXPECT_THAT(error_of(header("0.1.0", "0.2.0") + lines(0, 3)), HasSubstr("version is \"troupe 0.2.0\""));
  EXPECT_EQ(diff(header() + lines(0, 3), clang, {"--across-domains"}).code, 0);
  EXPECT_EQ(diff(header() + lines(0, 3), clang, {"--across-runs"}).code, 2);
  EXPECT_EQ(diff(header() + lines(0, 3), header("assertions off", "assertions on") + lines(0, 3)).code, 0);
}

TEST_F(Diff, AnotherInstructionSetOfTheKernelsIsNoOtherDomainOrRun) {
  const Outcome outcome =
      diff(header() + "# simd: avx2\n" + lines(0, 3), header() + "# simd: neon\n" + lines(0, 3));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(diff(header() + lines(0, 3), header() + "# simd: neon\n" + lines(0, 3)).code, 0);
}

TEST_F(Diff, OtherRunsAreComparedOnlyWhenToldTo) {
  const std::string seed = header("# seed: 1", "# seed: 7") + lines(0, 3);
  EXPECT_EQ(error_of(seed),
            "b.log:4: error: seed is \"7\", but \"1\" in a.log: these are different runs; --across-runs "
            "compares the files anyway\n");
  EXPECT_THAT(
      error_of(header("room", "hall") + lines(0, 3)),
      StartsWith(
          "b.log:3: error: world is \"hall.json\", but \"room.json\" in a.log: these are different runs"));
  EXPECT_THAT(error_of(header() + "# set /a: 3\n" + lines(0, 3)),
              StartsWith("b.log:10: error: set /a is \"3\", but \"\" in a.log: these are different runs"));
  EXPECT_EQ(diff(header() + lines(0, 3), seed, {"--across-runs"}).code, 0);
  EXPECT_EQ(diff(header() + lines(0, 3), header("worlds/room", "/elsewhere/room") + lines(0, 3)).code, 0);
}

TEST_F(Diff, MalformedLogsAreErrorsWithTheirLine) {
  EXPECT_EQ(error_of(header() + lines(0, 1) + "2 0123"),
            "b.log:12: error: the last line is incomplete: the log was cut off; remove this line to compare "
            "the other lines\n");
  const std::string form =
      " is not a line of a hash log; expected TICK STATE pose=HASH velocity=HASH sensor=HASH memory=HASH, "
      "with 16 lower-case hexadecimal digits for STATE and each HASH\n";
  EXPECT_EQ(error_of(header() + lines(0, 1) + "2 0123\n"), "b.log:12: error: \"2 0123\"" + form);
  std::string upper = line(0, 10);
  upper.replace(upper.find("a "), 1, "A");
  for (const std::string& wrong : {upper, fmt::format("x{}", line(0)), fmt::format("-1{}", line(0).substr(1)),
                                   fmt::format(" {}", line(0)), line(0).replace(20, 4, "posi")}) {
    EXPECT_EQ(
        error_of(header() + wrong),
        fmt::format("b.log:10: error: \"{}\"{}", wrong.substr(0, wrong.size() - 1).substr(0, 120), form));
  }
  EXPECT_EQ(error_of(header() + line(0) + line(2)),
            "b.log:11: error: tick 2 follows tick 0: the log is damaged, because lines are missing or "
            "repeated\n");
  std::string damaged = line(1);
  damaged[damaged.size() - 2] = '7';
  EXPECT_EQ(error_of(header() + line(0) + damaged),
            "b.log:11: error: the state hash is not the sum of the group hashes: the line is damaged\n");
  EXPECT_EQ(error_of(header() + "#seed 3\n" + line(0)),
            "b.log:10: error: \"#seed 3\" is not a header line; expected # KEY: VALUE\n");
  EXPECT_EQ(error_of(header() + "# seed: 1\n" + line(0)),
            "b.log:10: error: the header \"seed\" occurs twice\n");
  EXPECT_EQ(error_of(header()),
            "b.log: error: the log contains no tick to compare: its run ended before it wrote one; repeat "
            "the run\n");
  const std::string none =
      "b.log:1: error: not a hash log (troupe run --hash-log): the first line must be \"# troupe hash log "
      "1\"\n";
  for (const char* other : {"", "{}\n", "\x89PNG\r\n\x1a\n", "# troupe hash log 2\n", "no line break"})
    EXPECT_EQ(error_of(other), none);
}

// A reader of whole lines would need 64 GiB of memory for the first one.
TEST_F(Diff, AHugeFileWithoutLineBreaksIsNoHashLog) {
  write("huge.log", "");
  std::filesystem::resize_file(path("huge.log"), std::uintmax_t{64} << 30);  // takes no space on the disk
  const Outcome outcome = troupe({"diff", "huge.log", "huge.log"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err,
            "huge.log:1: error: not a hash log (troupe run --hash-log): the first line must be \"# troupe "
            "hash log 1\"\n");
}

TEST_F(Diff, FilesThatCannotBeReadAreErrors) {
  write("a.log", header() + lines(0, 1));
  const Outcome missing = troupe({"diff", "a.log", "none.log"});
  EXPECT_EQ(missing.code, 2);
  EXPECT_EQ(missing.err, "none.log: error: there is no such file\n");
  const Outcome folder = troupe({"diff", ".", "a.log"});
  EXPECT_EQ(folder.code, 2);
  EXPECT_EQ(folder.err, ".: error: this is a folder, not a file\n");
}

TEST_F(Diff, ComparesTablesOfSweepsRowByRow) {
  const std::string head = "run,speed,seed,ticks,time_s,coverage,stopped_by,state_hash,error\n";
  write("a.csv", head + "0,0.1,1,10,1,0.5,,aa,\n1,0.2,1,10,1,0.6,,bb,\"no, \"\"room\"\"\"\n");
  write("b.csv", head + "1,0.2,1,10,1,0.6,,bb,\"no, \"\"room\"\"\"\n0,0.1,1,10,1,0.5,,aa,\n");
  const Outcome same = troupe({"diff", "a.csv", "b.csv"});
  EXPECT_EQ(same.code, 0) << same.err;
  EXPECT_EQ(same.out, "same rows: 2 runs of 9 columns\n");
  write("c.csv",
        "run,speed,seed,ticks,time_s,coverage,stalls,stopped_by,state_hash,error\n"
        "0,0.1,1,10,1,0.51,3,,ac,\n2,0.3,1,10,1,0.7,0,,cc,\n");
  const Outcome other = troupe({"diff", "a.csv", "c.csv"});
  EXPECT_EQ(other.code, 1);
  EXPECT_EQ(other.out,
            "differs in 1 of 1 common row:\n  only in c.csv: column stalls\n  run 0: coverage 0.5 and 0.51, "
            "state_hash aa "
            "and ac\n  only in a.csv: run 1\n  only in c.csv: run 2\n");
  write("x.log", header() + lines(0, 3));
  EXPECT_EQ(troupe({"diff", "a.csv", "x.log"}).err,
            "x.log: error: this is not a table of troupe sweep, which the other file is\n");
  write("cut.csv", head + "0,0.1\n");
  EXPECT_EQ(troupe({"diff", "a.csv", "cut.csv"}).err,
            "cut.csv: error: row 2 has 2 cells, but there are 9 columns\n");
}

TEST_F(Diff, TakesWhatARunWrites) {
  write("room.world", k_room);
  const auto run = [&](const std::string& log, std::vector<std::string> options) {
    options.insert(options.begin(), {"run", "room.world", "--for", "2", "--quiet", "--hash-log", log});
    EXPECT_EQ(troupe(options).code, 0);
  };
  run("one.log", {"--threads", "1"});
  run("three.log", {"--threads", "3", "--tile-size", "0.9"});
  run("seven.log", {"--seed", "7"});
  const Outcome same = troupe({"diff", "one.log", "three.log"});
  EXPECT_EQ(same.code, 0) << same.err;
  EXPECT_THAT(same.out, MatchesRegex("same bits, tick 0 to 20; the last state has the hash [0-9a-f]{16}\n"));
  EXPECT_THAT(troupe({"diff", "one.log", "seven.log"}).err, HasSubstr("seed is \"7\", but \"1\" in one.log"));
  const Outcome other = troupe({"diff", "one.log", "seven.log", "--across-runs"});
  EXPECT_EQ(other.code, 1);
  EXPECT_THAT(other.out,
              MatchesRegex("differs at tick [0-9]+, in [a-z, ]+:\n  one.log:.*\n  seven.log:.*\n"));
}

}  // namespace
}  // namespace troupe::apps::diff_test
