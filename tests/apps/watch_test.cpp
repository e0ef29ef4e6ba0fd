#include "tests/apps/program.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <nlohmann/json.hpp>

#include <chrono>
#include <csignal>
#include <cstdlib>

namespace troupe::apps::watch_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::Not;

class Watch : public ProgramTest {
 protected:
  /// A world with one body that is no robot, and this at its top level.
  void write_world(const std::string& name, const std::string& top_level) {
    write(name, "name \"arena\"\n" + top_level + "\nmodel( size [0.2 0.2 0.2] )\n");
  }
  /// Wall time of a run that must end well, and what it took.
  std::pair<double, nlohmann::json> timed(std::vector<std::string> options) const {
    options.insert(options.begin(), {"run", "w.world", "--json"});
    const auto start = std::chrono::steady_clock::now();
    const Outcome outcome = troupe(options);
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return {wall.count(), nlohmann::json::parse(outcome.out)};
  }
};

TEST_F(Watch, StagePathIsWhereWorldsAndIncludesAreLookedFor) {
  for (const char* folder : {"first", "second"}) std::filesystem::create_directory(path(folder));
  write("second/w.world", "include \"robots.inc\"\nbot()\n");
  write("second/robots.inc", "define bot position()\n");
  EXPECT_EQ(troupe({"run", "w.world", "--for", "0.1"}).code, 2);
  setenv("STAGEPATH", "first:second", 1);
  const Outcome outcome = troupe({"run", "elsewhere/w.world", "--for", "0.1", "--json"});
  unsetenv("STAGEPATH");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(outcome.out).at("robots"), 1);
}

// The clock.

TEST_F(Watch, ShowClockTellsTheTimeAsOftenAsTheWorldSays) {
  write_world("w.world", "show_clock 1 show_clock_interval 5");
  EXPECT_THAT(lines_of(troupe({"run", "w.world", "--for", "1.2"}).err),
              ElementsAre("arena: 0 s", MatchesRegex("arena: 0.5 s, [0-9.,]+ x real time"),
                          MatchesRegex("arena: 1 s, [0-9.,]+ x real time")));
  EXPECT_THAT(troupe({"run", "w.world", "--for", "1.2", "--quiet"}).err, IsEmpty());
  write_world("w.world", "show_clock 0 show_clock_interval 5");
  EXPECT_THAT(troupe({"run", "w.world", "--for", "1.2"}).err, IsEmpty());
}

TEST_F(Watch, TheClockIsThereForWhoAsksForIt) {
  write_world("w.world", "");
  EXPECT_THAT(lines_of(troupe({"run", "w.world", "--for", "12", "--clock"}).err),
              ElementsAre("arena: 0 s", MatchesRegex("arena: 10 s, [0-9.,]+ x real time")));
  write_world("w.world", "show_clock_interval 60");
  EXPECT_THAT(lines_of(troupe({"run", "w.world", "--for", "7", "--clock"}).err),
              ElementsAre("arena: 0 s", MatchesRegex("arena: 6 s, [0-9.,]+ x real time")));
}

TEST_F(Watch, LinesAndAProgressBarDoNotMix) {
  if (!has_terminals()) GTEST_SKIP() << "the system has no pseudo-terminals (/dev/pts)";
  write_world("w.world", "");
  // Held back, it takes 2.5 s, in which a progress bar is shown without --clock.
  const Outcome outcome = troupe_on_terminal({"run", "w.world", "--for", "5", "--rate", "2", "--clock"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("arena: 0 s"));
  EXPECT_THAT(outcome.err, Not(HasSubstr("left")));
}

// The pace.

TEST_F(Watch, ARateHoldsTheRunBack) {
  write_world("w.world", "interval_sim 10");
  const auto [wall_s, summary] = timed({"--for", "0.5", "--rate", "1"});
  EXPECT_GE(wall_s, 0.5);
  EXPECT_LE(summary.at("times_real_time").get<double>(), 1.01);  // what lies between two ticks is not in it
  EXPECT_EQ(summary.at("rate"), 1);
  EXPECT_GT(summary.at("waited_s").get<double>(), 0);
  EXPECT_EQ(summary.at("ticks"), 50);
  EXPECT_THAT(troupe({"run", "w.world", "--for", "0.1", "--rate", "2"}).out,
              ::testing::AllOf(HasSubstr("rate               2 x real time"),
                               HasSubstr(" s, to keep 2 x real time")));
}

TEST_F(Watch, TheWorldsOwnRateHoldsBackWhoAsksForIt) {
  write_world("w.world", "speedup 2");
  EXPECT_GE(timed({"--for", "0.6", "--rate", "world"}).first, 0.3);
  const auto [wall_s, summary] = timed({"--for", "600"});  // as fast as it can, unless it is asked
  EXPECT_LT(wall_s, 290) << "it is held back";  // at twice the speed of real time, it would take 300 s
  EXPECT_FALSE(summary.contains("rate"));
  write_world("w.world", "speedup -1");
  EXPECT_LT(timed({"--for", "600", "--rate", "world"}).first, 290);
  write_world("w.world", "");
  EXPECT_EQ(timed({"--for", "0.2", "--rate", "world"}).second.at("rate"), 1);
}

TEST_F(Watch, TheRateChangesNoResult) {
  write("w.world", k_room);
  EXPECT_EQ(timed({"--for", "0.4", "--rate", "4"}).second.at("state_hash"),
            timed({"--for", "0.4"}).second.at("state_hash"));
}

TEST_F(Watch, ASlowRunEndsAtOnceWhenItIsStopped) {
  write_world("w.world", "interval_sim 1000000");
  const auto start = std::chrono::steady_clock::now();
  const Outcome outcome = troupe_until(
      {"run", "w.world", "--for", "1e6", "--rate", "1", "--hash-log", "h.log"}, "h.log", 8, SIGINT);
  EXPECT_EQ(outcome.code, 3);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(900)) << "a tick is 1000 s";
}

TEST_F(Watch, OtherRatesAreRefused) {
  write_world("w.world", "");
  for (const char* rate : {"0", "-1", "fast", "1x", "nan"}) {
    const Outcome outcome = troupe({"run", "w.world", "--for", "1", "--rate", rate});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err,
                HasSubstr("is not a multiple of real time from 0.001 to 1000000000, or the word world"))
        << rate;
  }
}

// Several worlds.

class Worlds : public Watch {};

TEST_F(Worlds, RunSideBySideEachToItsOwnEnd) {
  write_world("a.world", "interval_sim 20 quit_time 0.5");
  write_world("b.world", "quit_time 2");
  const Outcome outcome = troupe({"run", "a.world", "b.world", "--json"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const std::vector<std::string> lines = lines_of(outcome.out);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(nlohmann::json::parse(lines[0]).at("world"), "a.world");
  EXPECT_EQ(nlohmann::json::parse(lines[0]).at("ticks"), 25);
  EXPECT_EQ(nlohmann::json::parse(lines[1]).at("ticks"), 20);
  const std::string text = troupe({"run", "a.world", "b.world", "--for", "1"}).out;
  EXPECT_THAT(text, HasSubstr("a.world: finished\n"));
  EXPECT_THAT(text, HasSubstr("b.world: finished\n"));
}

TEST_F(Worlds, GoOnInTheOrderOfTheirTimes) {
  write("a.world", "name \"a\" interval_sim 300 show_clock 1 show_clock_interval 1");
  write("b.world", "name \"b\" interval_sim 200 show_clock 1 show_clock_interval 1");
  std::vector<std::string> told = lines_of(troupe({"run", "a.world", "b.world", "--for", "0.9"}).err);
  for (std::string& line : told) line.resize(line.find(" s"));
  EXPECT_THAT(told, ElementsAre("a: 0", "b: 0", "b: 0.2", "a: 0.3", "b: 0.4", "a: 0.6", "b: 0.6", "b: 0.8",
                                "a: 0.9", "b: 1"));
}

TEST_F(Worlds, GiveTheBitsThatEachGivesAlone) {
  write("a.world", k_room);
  write("b.world", "seed 9\n" + std::string(k_room));
  ASSERT_EQ(
      troupe({"run", "a.world", "b.world", "--for", "1", "--quiet", "--hash-log", "both-{world}.log"}).code,
      0);
  for (const std::string world : {"a", "b"}) {
    ASSERT_EQ(troupe({"run", world + ".world", "--for", "1", "--quiet", "--hash-log", "{world}.log"}).code,
              0);
    EXPECT_EQ(read("both-" + world + ".log"), read(world + ".log"));
  }
  EXPECT_NE(read("a.log"), read("b.log"));
}

TEST_F(Worlds, WhatIsWrongWithAnyIsToldBeforeAnyRuns) {
  write_world("a.world", "quit_time 1");
  write_world("b.world", "unit_length \"km\"");
  write_world("c.world", "");
  const Outcome outcome = troupe({"run", "a.world", "b.world", "c.world", "--hash-log", "{world}.log"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(lines_of(outcome.err),
              ElementsAre("b.world:2: error: unknown unit_length \"km\"; known: m, cm, mm",
                          "c.world: error: no end time: give --for SECONDS, or set quit_time in "
                          "the world"));
  EXPECT_THAT(files(), ElementsAre("a.world", "b.world", "c.world"));
}

TEST_F(Worlds, OutputsNeedNamesOfTheirOwn) {
  write_world("a.world", "");
  std::filesystem::create_directory(path("sub"));
  write("sub/a.world", "model()");
  const Outcome shared = troupe({"run", "a.world", "sub/a.world", "--for", "1", "--hash-log", "out.log"});
  EXPECT_EQ(shared.code, 2);
  EXPECT_THAT(
      lines_of(shared.err),
      ElementsAre("troupe run: error: several worlds need different outputs: write {world} in the name, as "
                  "in {world}-out.log; the name of the world replaces {world}"));
  const Outcome equal = troupe({"run", "a.world", "sub/a.world", "--for", "1", "--hash-log", "{world}.log"});
  EXPECT_EQ(equal.code, 2);
  EXPECT_THAT(
      lines_of(equal.err),
      ElementsAre(
          "a.log: error: cannot be written: another output has the same name: choose another file name"));
}

TEST_F(Worlds, AreAllSavedWhenTheyAreStopped) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  write("a.world", k_room);
  write("b.world", k_room);
  const Outcome outcome = troupe({"run", "a.world", "b.world", "--for", "1e6", "--wall-limit", "0.3",
                                  "--checkpoint", "{world}.h5", "--json"});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  for (const std::string world : {"a", "b"})
    EXPECT_EQ(troupe({"resume", world + ".h5", "--for", "1e6", "--wall-limit", "0.1", "--quiet"}).code, 3);
}

}  // namespace
}  // namespace troupe::apps::watch_test
