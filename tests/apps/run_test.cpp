#include "tests/apps/program.hpp"

#include "apps/numbers.hpp"
#include "apps/outputs.hpp"
#include "partition/simd_target.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/slow_build.hpp"
#include "worldio/file_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

namespace troupe::apps::run_test {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::Not;
using ::testing::StartsWith;

class Run : public ProgramTest {
 protected:
  Run() { write("room.world", k_room); }

  /// The JSON of a run that must end well.
  nlohmann::json json(std::vector<std::string> options) const {
    options.insert(options.begin(), {"run", "room.world", "--json"});
    const Outcome outcome = troupe(options);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out);
  }

  /// The lines of a hash log that must agree between runs.
  std::vector<std::string> ticks(const std::string& log) const {
    std::vector<std::string> lines = lines_of(read(log));
    std::erase_if(lines, [](const std::string& line) { return line.starts_with('#'); });
    return lines;
  }
};

TEST_F(Run, SummaryNamesEverythingInAlignedLines) {
  const Outcome outcome = troupe({"run", "room.world", "--for", "1", "--threads", "2", "--seed", "7"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, StartsWith("running\n"));
  EXPECT_THAT(lines_of(outcome.out), Contains(MatchesRegex("  until_s +1")));
  EXPECT_THAT(lines_of(outcome.out), Contains(MatchesRegex("  seed +7")));
  EXPECT_THAT(lines_of(outcome.out), Contains(MatchesRegex("  tile_m +[0-9.]{1,5}")));
  for (const char* line : {"robots +12", "ticks +10 of 0.1 s", "simulated +1 s",
                           "wall +[-0-9.e]+ s, after [-0-9.e]+ s of loading", "times real time +[0-9.,]+",
                           "cost +[0-9.,]+ ns per robot and tick", "beams +108 per tick",
                           "phases +intervene [0-9.]+ %, sense [0-9.]+ %, actuate [0-9.]+ %, decide [0-9.]+ "
                           "%, move [0-9.]+ %, index [0-9.]+ %, observe [0-9.]+ %",
                           "threads +2", "peak memory +[0-9.]+ MiB", "stalled +[0-9]+ .[0-9.]+ %.",
                           "mean displacement +[0-9.]+ m", "state hash +[0-9a-f]{16}"})
    EXPECT_THAT(lines_of(outcome.out), Contains(MatchesRegex("  " + std::string(line))));
}

TEST_F(Run, SummaryOfAWorldWithoutRobotsHasNoCostPerRobot) {
  write("empty.json", R"({"troupe": 1, "arena": {"size_m": [4, 4]}})");
  const Outcome outcome = troupe({"run", "empty.json", "--for", "1"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(lines_of(outcome.out), Contains(MatchesRegex("  robots +0")));
  EXPECT_THAT(outcome.out, Not(HasSubstr("per robot")));
}

TEST_F(Run, JsonIsOneFlatObjectAndNothingElse) {
  const Outcome outcome = troupe({"run", "room.world", "--for", "1", "--json", "--seed", "9"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(lines_of(outcome.out).size(), 1u);
  const auto json = nlohmann::json::parse(outcome.out);
  std::stringstream page;
  page << std::ifstream(test::source_dir() / "docs/measures.md").rdbuf();
  const std::string text = page.str();
  const std::size_t begin = text.find("## The summary");
  const std::string documented = text.substr(begin, text.find("## List of measures") - begin);
  for (const auto& [key, value] : json.items()) {
    EXPECT_TRUE(value.is_primitive()) << key;
    EXPECT_THAT(documented, HasSubstr("`" + key + "`"));
  }
  for (const char* key :
       {"robots", "ticks", "sim_s", "wall_s", "times_real_time", "ns_per_robot_tick", "beams_per_tick",
        "threads", "stalled", "mean_displacement_m", "load_s", "peak_rss_bytes"})
    EXPECT_TRUE(json.at(key).is_number()) << key;
  EXPECT_EQ(json.at("robots"), 12);
  EXPECT_EQ(json.at("ticks"), 10);
  EXPECT_DOUBLE_EQ(json.at("sim_s").get<double>(), 1.0);
  EXPECT_EQ(json.at("beams_per_tick"), 108);
  EXPECT_EQ(json.at("seed"), 9);
  EXPECT_GT(json.at("peak_rss_bytes"), 1 << 20);
  EXPECT_NEAR(json.at("times_real_time").get<double>(), 1.0 / json.at("wall_s").get<double>(), 1e-6);
  EXPECT_NEAR(json.at("ns_per_robot_tick").get<double>(), json.at("wall_s").get<double>() * 1e9 / 120, 1e-3);
  EXPECT_THAT(json.at("state_hash").get<std::string>(), MatchesRegex("[0-9a-f]{16}"));
  EXPECT_FALSE(json.at("stopped_early").get<bool>());
  double shares = json.at("share_observe");
  for (const char* phase : {"intervene", "sense", "actuate", "decide", "move", "index"})
    shares += json.at(std::string("share_") + phase).get<double>();
  EXPECT_NEAR(shares, 1, 1e-6);
  EXPECT_GT(json.at("serial_share"), 0);
  EXPECT_LT(json.at("serial_share"), 1);
  EXPECT_GE(json.at("imbalance"), 1 - 1e-9);
  EXPECT_LE(json.at("imbalance").get<double>(), json.at("threads").get<double>() + 1e-9);
}

TEST_F(Run, FileNamesThatAreNotUtf8GiveValidJson) {
  write("caf\xe9.world", k_room);
  const Outcome run = troupe({"run", "caf\xe9.world", "--for", "0.5", "--json", "--profile", "p\xe9.json"});
  EXPECT_EQ(run.code, 0) << run.err;
  const nlohmann::json summary = nlohmann::json::parse(run.out);  // throws if a text is not UTF-8
  EXPECT_EQ(summary.at("world"), "caf\xef\xbf\xbd.world") << "with the replacement character U+FFFD";
  EXPECT_TRUE(nlohmann::json::accept(read("p\xe9.json")));
  const Outcome dry = troupe({"run", "caf\xe9.world", "--for", "0.5", "--json", "--dry-run"});
  EXPECT_EQ(dry.code, 0) << dry.err;
  EXPECT_TRUE(nlohmann::json::accept(dry.out));
  EXPECT_EQ(troupe({"run", "none\xe9.world"}).err, "none\xe9.world: error: there is no such file\n");
}

TEST_F(Run, SummariesCountWhatAllRanksHoldAndSend) {
  const std::vector<std::string> options{"--for",       "1", "--ranks",        "3",  "--threads", "1",
                                         "--tile-size", "1", "--rank-balance", "off"};
  const nlohmann::json replicated = json(options);
  EXPECT_EQ(replicated.at("rank_form"), "replicated");
  EXPECT_EQ(replicated.at("ranks_own_mean"), 4);
  EXPECT_EQ(replicated.at("ranks_own_most"), 4);
  EXPECT_EQ(replicated.at("ranks_imbalance"), 1);
  EXPECT_FALSE(replicated.contains("ranks_ghosts_mean"));
  EXPECT_GE(replicated.at("ranks_messages_mean"), 2) << "one to each other rank";

  std::vector<std::string> distribute = options;
  distribute.emplace_back("--distribute");
  const nlohmann::json summary = json(distribute);
  EXPECT_EQ(summary.at("state_hash"), replicated.at("state_hash"));
  EXPECT_EQ(summary.at("rank_form"), "distributed");
  EXPECT_NEAR(summary.at("ranks_own_mean").get<double>(), 4, 1e-9) << "each robot has one owner";
  for (const char* count : {"own", "ghosts", "neighbours", "rounds", "migrated", "messages", "bytes"})
    EXPECT_LE(summary.at(std::string("ranks_") + count + "_mean").get<double>(),
              summary.at(std::string("ranks_") + count + "_most").get<double>() + 1e-9)
        << count;
  EXPECT_GT(summary.at("ranks_ghosts_mean"), 0);
  EXPECT_LE(summary.at("ranks_neighbours_most"), 2);
  EXPECT_NEAR(summary.at("rank_ghosts_per_row").get<double>(),
              summary.at("ranks_ghosts_mean").get<double>() / 4, 1e-9);
  EXPECT_LE(summary.at("rank_bytes_per_tick"), summary.at("ranks_bytes_most"));
  EXPECT_EQ(json(distribute).at("ranks_bytes_most"), summary.at("ranks_bytes_most")) << "not reproducible";

  std::vector<std::string> text = distribute;
  text.insert(text.begin(), {"run", "room.world"});
  for (const char* line :
       {"per rank +[0-9.,]+ messages .at most [0-9.,]+., [0-9.,]+ bytes .at most [0-9.,]+., in each tick",
        "robots per rank +4 own .at most [0-9.]+., [0-9.]+ ghosts .at most [0-9.]+., imbalance [0-9.]+",
        "neighbours +[0-9.]+ neighbouring ranks .at most [0-9.]+., [0-9.]+ rounds of messages .at most "
        "[0-9.]+., per rank and tick",
        "robot data +distributed: [0-9.]+ ghosts .copies of robots of other ranks. per own robot; robots "
        "divided among the ranks [0-9]+ times?"})
    EXPECT_THAT(lines_of(troupe(text).out), Contains(MatchesRegex("  " + std::string(line))));
}

TEST_F(Run, ADryRunPrintsWhatTheRunWouldNeed) {
  const Outcome alone = troupe(
      {"run", "room.world", "--for", "2", "--dry-run", "--hash-log", "dry.log", "--checkpoint", "dry.h5"});
  EXPECT_EQ(alone.code, 0) << alone.err;
  EXPECT_FALSE(std::filesystem::exists(path("dry.log")));
  EXPECT_FALSE(std::filesystem::exists(path("dry.h5")));
  EXPECT_THAT(alone.out, StartsWith("options\n"));
  for (const char* line :
       {"robots +12", "ticks +20, until 2 s",
        "memory +[0-9.]+ MiB with the whole world, of which [0-9.e-]+ MiB are state tables"})
    EXPECT_THAT(lines_of(alone.out), Contains(MatchesRegex("  " + std::string(line))));

  const std::vector<std::string> options{"--for",     "0.1", "--ranks",     "3",
                                         "--threads", "1",   "--tile-size", "1"};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = options;
    all.insert(all.end(), more.begin(), more.end());
    return json(all);
  };
  const nlohmann::json plan = with({"--distribute", "--dry-run"});
  const nlohmann::json run = with({"--distribute"});  // the robots stand still in the first tick
  EXPECT_EQ(plan.at("rank_form"), "distributed");
  EXPECT_EQ(plan.at("ranks_own_most"), run.at("ranks_own_most"));
  EXPECT_GE(plan.at("ranks_ghosts_mean"), run.at("ranks_ghosts_mean")) << "the robots drive at no speed yet";
  EXPECT_GE(plan.at("ranks_neighbours_most"), 1);
  EXPECT_GT(plan.at("coverage_m"), 0);
  EXPECT_LE(plan.at("ranks_state_bytes_most"), plan.at("state_bytes"));
  const nlohmann::json whole = with({"--dry-run"});
  EXPECT_EQ(whole.at("rank_form"), "replicated");
  EXPECT_EQ(whole.at("ranks_state_bytes_mean"), whole.at("state_bytes"));

  write("walker.json", R"({"troupe": 1, "types": {"walker": {"size_m": [0.2, 0.2, 0.2],
      "devices": [{"name": "feet", "kind": "wheels", "size_m": [0.1, 0.1, 0.1]}]}},
      "models": [{"name": "r", "type": "walker"}]})");
  const Outcome walker =
      troupe({"run", "walker.json", "--for", "1", "--ranks", "3", "--distribute", "--dry-run"});
  EXPECT_EQ(walker.code, 0) << walker.err;
  EXPECT_THAT(lines_of(walker.out),
              Contains(MatchesRegex("  robot data +replicated: each rank has all robots, because robots of "
                                    "type \"walker\" have the device \"feet\" of the kind \"wheels\", .*")));
  EXPECT_EQ(troupe({"run", "none.world", "--for", "1", "--dry-run"}).code, 2);
}

TEST_F(Run, OneWorkerIsNeverOutOfBalance) {
  const Outcome outcome = troupe({"run", "room.world", "--for", "1", "--threads", "1", "--json"});
  EXPECT_NEAR(nlohmann::json::parse(outcome.out).at("imbalance").get<double>(), 1, 1e-9);
}

TEST_F(Run, OnEveryInstructionSetGivesTheSameBitsAndNamesIt) {
  std::vector<std::string> expected;
  for (const std::string& name : partition::simd_targets().usable) {
    const nlohmann::json summary = json({"--for", "2", "--simd", name, "--hash-log", name + ".log"});
    EXPECT_EQ(summary.at("simd"), name);
    EXPECT_THAT(lines_of(read(name + ".log")), Contains("# simd: " + name));
    if (expected.empty()) expected = ticks(name + ".log");
    EXPECT_EQ(ticks(name + ".log"), expected) << name;
  }
  EXPECT_EQ(expected.size(), 21u);
}

TEST_F(Run, TheInstructionSetOfTheEnvironmentHoldsUnlessAnotherIsGiven) {
  const std::string worst = partition::simd_targets().usable.back();
  const std::string best = partition::simd_targets().usable.front();
  setenv("TROUPE_SIMD", worst.c_str(), 1);
  EXPECT_EQ(json({"--for", "1"}).at("simd"), worst);
  EXPECT_EQ(json({"--for", "1", "--simd", best}).at("simd"), best);
  EXPECT_THAT(troupe({"--version"}).out, HasSubstr(" simd " + worst + " (available: " + best));
  setenv("TROUPE_SIMD", "avx9", 1);
  const Outcome refused = troupe({"run", "room.world", "--for", "1"});
  setenv("TROUPE_SIMD", "", 1);
  EXPECT_EQ(json({"--for", "1"}).at("simd"), best);
  unsetenv("TROUPE_SIMD");
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err,
              StartsWith("TROUPE_SIMD: error: \"avx9\" is not an instruction set that this program is"));
}

constexpr std::string_view k_runner = R"({"troupe": 1, "bounds_m": [[-1, -1], [20, 1]],
  "types": {"bot": {"size_m": [0.4, 0.4, 0.4], "drive": {"kind": "diff"},
    "controller": {"kind": "script", "legs": [{"until_s": 1000, "forward_mps": 1}]}}},
  "models": [{"name": "r", "type": "bot"}],
  "stop_when": ["alive == 0", "displacement >= 0.95"]})";

TEST_F(Run, EndsWhereTheWorldSaysThatItIsOver) {
  write("w.json", k_runner);
  const Outcome text = troupe({"run", "w.json", "--for", "60", "--hash-log", "h.log"});
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("finished at 1.1 of 60 s: displacement >= 0.95\n"));
  EXPECT_EQ(ticks("h.log").size(), 12u);
  const Outcome json = troupe({"run", "w.json", "--for", "60", "--json"});
  const auto summary = nlohmann::json::parse(json.out);
  EXPECT_EQ(summary.at("stopped_by"), "displacement >= 0.95");
  EXPECT_FALSE(summary.at("stopped_early").get<bool>());
  EXPECT_EQ(summary.at("ticks"), 11);
  const Outcome whole = troupe({"run", "w.json", "--for", "2", "--json", "--set", "/stop_when=[]"});
  EXPECT_EQ(nlohmann::json::parse(whole.out).at("ticks"), 20);
  EXPECT_FALSE(nlohmann::json::parse(whole.out).contains("stopped_by"));
}

TEST_F(Run, TellsWhichMeasureIsWrong) {
  const std::string types = R"({"troupe": 1, "quit_time_s": 1,
  "types": {"bot": {"size_m": [0.4, 0.4, 0.4], "drive": {"kind": "diff"}}},
  "models": [{"name": "r", "type": "bot"}],
)";
  write("stop.json", types + R"("stop_when": ["alive == 0", "alive == 7", "stalls:bat > 3"]})");
  Outcome outcome = troupe({"run", "stop.json"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err,
              HasSubstr("stop.json:4: error: /stop_when/2: unknown type or population of robots \"bat\""));
  write("measures.json", types + R"("measures": ["alive", {"kind": "stalls", "name": "alive"}]})");
  outcome = troupe({"run", "measures.json", "--measures", "m.csv"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err,
              HasSubstr("measures.json:4: error: /measures/1: two measures have the column \"alive\""));
  outcome = troupe({"run", "measures.json", "--measures", "m.csv", "--measure", "stalls:bat"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, Not(HasSubstr("/measures/"))) << "the measure is not that of the file";
}

TEST_F(Run, TellsWhatIsWrongWithAnExperiment) {
  write("w.json", R"({"troupe": 1,
  "types": {"bot": {"size_m": [0.4, 0.4, 0.4], "drive": {"kind": "diff"}}},
  "models": [{"name": "r", "type": "bot"}],
  "stop_when": ["covrage >= 0.9"],
  "at": [{"time_s": 1, "remove": {"model": "r"}, "add": {}}],
  "faults": [{"model": "r", "slow_wheels": {"factor": 2}}]})");
  const Outcome outcome = troupe({"run", "w.json", "--for", "1"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("w.json:4: error: /stop_when/0: unknown measure \"covrage\""));
  EXPECT_THAT(outcome.err, HasSubstr("w.json:5: error: /at/0: the entry has several actions"));
  EXPECT_THAT(outcome.err, HasSubstr("w.json:6: error: /faults/0/slow_wheels/factor: must be above 0"));
}

TEST_F(Run, QuietPrintsNothing) {
  const Outcome outcome = troupe({"run", "room.world", "--for", "0.5", "--quiet", "--hash-log", "h.log"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(outcome.err, IsEmpty());
  EXPECT_EQ(ticks("h.log").size(), 6u);
}

TEST_F(Run, QuietKeepsTheJsonThatWasAskedFor) {
  const Outcome outcome = troupe({"run", "room.world", "--for", "0.5", "--quiet", "--json"});
  EXPECT_EQ(nlohmann::json::parse(outcome.out).at("ticks"), 5);
}

TEST_F(Run, EndsWithTheFirstTickAtOrAfterTheTime) {
  // 0.1 is not a binary number: 0.3 / 0.1 is below 3, and 3 * 0.1 above 0.3.
  const std::vector<std::pair<std::string, int>> cases{{"0", 0},   {"0.05", 1}, {"0.1", 1},  {"0.25", 3},
                                                       {"0.3", 3}, {"0.7", 7},  {"1.1", 11}, {"2.9", 29}};
  for (const auto& [time, expected] : cases) EXPECT_EQ(json({"--for", time}).at("ticks"), expected) << time;
}

TEST_F(Run, NoTicksGiveNumbersAndNoInfinities) {
  const auto summary = json({"--for", "0", "--hash-log", "h.log"});
  for (const char* key : {"ticks", "sim_s", "times_real_time", "ns_per_robot_tick", "beams_per_tick"})
    EXPECT_EQ(summary.at(key), 0) << key;
  EXPECT_EQ(ticks("h.log").size(), 1u);
  EXPECT_EQ(troupe({"run", "room.world", "--for", "0"}).code, 0);
}

TEST_F(Run, NoRobotsGiveNumbersAndNoInfinities) {
  write("empty.world", "model( size [1 1 1] )\n");
  const Outcome outcome = troupe({"run", "empty.world", "--for", "1", "--json"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const auto summary = nlohmann::json::parse(outcome.out);
  for (const char* key : {"robots", "ns_per_robot_tick", "beams_per_tick", "mean_displacement_m"})
    EXPECT_EQ(summary.at(key), 0) << key;
  EXPECT_THAT(troupe({"run", "empty.world", "--for", "1"}).out, HasSubstr("stalled            0 (0.0 %)"));
}

TEST_F(Run, TheWorldsQuitTimeEndsARunUnlessForIsGiven) {
  write("quit.world", "quit_time 0.7\n" + std::string(k_room));
  EXPECT_EQ(nlohmann::json::parse(troupe({"run", "quit.world", "--json"}).out).at("ticks"), 7);
  EXPECT_EQ(nlohmann::json::parse(troupe({"run", "quit.world", "--json", "--for", "1.2"}).out).at("ticks"),
            12);
}

TEST_F(Run, WithNoEndAtAllBothWaysAreNamed) {
  const Outcome outcome =
      troupe({"run", "room.world", "--hash-log", "h.log", "--snapshot", "p.png", "--quiet"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(lines_of(outcome.err),
              ElementsAre("room.world: error: no end time: give --for SECONDS, or set quit_time in the "
                          "world"));
  EXPECT_THAT(files(), ElementsAre("room.world"));
}

TEST_F(Run, HashLogHasAHeaderAndOneLineATickFromTickZero) {
  const auto summary = json({"--for", "2", "--hash-log", "h.log"});
  std::vector<std::string> lines = lines_of(read("h.log"));
  const auto first =
      std::ranges::find_if(lines, [](const std::string& line) { return !line.starts_with('#'); });
  ASSERT_NE(first, lines.begin());
  EXPECT_THAT(std::vector(lines.begin(), first), Each(MatchesRegex("# .+")));
  for (const char* key : {"# version: troupe ", "# world: room.world", "# seed: 1", "# threads: "})
    EXPECT_THAT(std::vector(lines.begin(), first), Contains(StartsWith(key)));
  const std::vector<std::string> rest(first, lines.end());
  ASSERT_EQ(rest.size(), 21u);
  for (std::size_t tick = 0; tick < rest.size(); ++tick)
    EXPECT_THAT(rest[tick],
                MatchesRegex(std::to_string(tick) + " [0-9a-f]{16} pose=[0-9a-f]{16} velocity=[0-9a-f]{16} "
                                                    "sensor=[0-9a-f]{16} memory=[0-9a-f]{16}"));
  EXPECT_THAT(rest.back(), StartsWith("20 " + summary.at("state_hash").get<std::string>() + " "));
  EXPECT_NE(rest[19].substr(3, 16), rest[20].substr(3, 16));
}

TEST_F(Run, ThreadsAndTilesDoNotChangeTheHashLog) {
  std::vector<std::vector<std::string>> logs;
  for (const char* threads : {"1", "2", "8"})
    for (const char* tile : {"1", "5"}) {
      const auto summary =
          json({"--for", "3", "--threads", threads, "--tile-size", tile, "--hash-log", "h.log"});
      EXPECT_EQ(summary.at("threads"), std::stoi(threads));
      logs.push_back(ticks("h.log"));
    }
  ASSERT_EQ(logs.front().size(), 31u);
  EXPECT_THAT(logs, Each(logs.front()));
}

TEST_F(Run, TheSeedChangesTheRun) {
  EXPECT_NE(json({"--for", "3", "--seed", "1"}).at("state_hash"),
            json({"--for", "3", "--seed", "2"}).at("state_hash"));
  EXPECT_EQ(json({"--for", "3", "--seed", "1"}).at("state_hash"), json({"--for", "3"}).at("state_hash"));
}

class Signals : public Run, public ::testing::WithParamInterface<int> {};

TEST_P(Signals, EndTheRunAfterTheTickWithEverythingWritten) {
  const Outcome outcome =
      troupe_until({"run", "room.world", "--for", "1e9", "--hash-log", "h.log"}, "h.log", 30, GetParam());
  EXPECT_EQ(outcome.code, 3);
  // A closed terminal, SIGHUP, shows no message.
  EXPECT_EQ(outcome.err, GetParam() == SIGHUP
                             ? ""
                             : "troupe run: stopping after the current tick; a second Ctrl-C or SIGTERM ends "
                               "the program at once\n");
  EXPECT_THAT(outcome.out, HasSubstr("stopped early at "));
  EXPECT_THAT(lines_of(outcome.out), Contains(MatchesRegex("  state hash +[0-9a-f]{16}")));
  const std::vector<std::string> log = ticks("h.log");
  const std::string& last = log.back();
  EXPECT_THAT(last, MatchesRegex("[0-9]+ [0-9a-f]{16} pose=.* memory=[0-9a-f]{16}"));
  EXPECT_THAT(outcome.out, HasSubstr(last.substr(last.find(' ') + 1, 16)));
}

TEST_P(Signals, PrintNothingInAQuietRun) {
  const Outcome outcome = troupe_until(
      {"run", "room.world", "--for", "1e9", "--quiet", "--hash-log", "h.log"}, "h.log", 30, GetParam());
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, IsEmpty());
}

/// Whether a process that this thread has started handles a signal.
bool child_handles(int signal) {
  std::ifstream children(fmt::format("/proc/self/task/{}/children", gettid()));
  pid_t child = 0;
  if (!(children >> child)) return false;
  std::ifstream status(fmt::format("/proc/{}/status", child));
  for (std::string key, value; status >> key && std::getline(status, value);)
    if (key == "SigCgt:") return (std::stoull(value, nullptr, 16) >> (signal - 1) & 1) != 0;
  return false;
}

/// Opening a pipe waits for its reader, and the system repeats the call after a signal.
TEST_P(Signals, EndAProgramThatWaitsForTheReaderOfAPipe) {
  struct Output {
    const char* option;
    const char* pipe;
  };
  for (const auto& [option, pipe] : {Output{"--hash-log", "pipe.log"}, Output{"--measures", "pipe.csv"},
                                     Output{"--events", "pipe.events.csv"}, Output{"--profile", "pipe.json"},
                                     Output{"--snapshot", "pipe.svg"}}) {
    SCOPED_TRACE(option);
    ASSERT_EQ(mkfifo(path(pipe).c_str(), 0600), 0);
    const Outcome outcome =
        troupe_with_signals({"run", "room.world", "--for", "0.3", option, pipe, "--quiet"},
                            {{GetParam(), [] { return child_handles(GetParam()); }}});
    if (lacks_pictures(outcome)) continue;
    EXPECT_EQ(outcome.code, 3);
    EXPECT_EQ(outcome.err,
              fmt::format("{}: error: nothing was written: the program was stopped before another "
                          "program read this pipe\n",
                          pipe));
  }
}

TEST_P(Signals, AreToldInTheJson) {
  const Outcome outcome = troupe_until({"run", "room.world", "--for", "1e9", "--json", "--hash-log", "h.log"},
                                       "h.log", 30, GetParam());
  EXPECT_EQ(outcome.code, 3);
  EXPECT_TRUE(nlohmann::json::parse(outcome.out).at("stopped_early").get<bool>());
}

INSTANTIATE_TEST_SUITE_P(Run, Signals, ::testing::Values(SIGINT, SIGTERM, SIGHUP));

TEST_F(Run, ProgressIsShownOnATerminalAndWipedOff) {
  if (!has_terminals()) GTEST_SKIP() << "the system has no pseudo-terminals (/dev/pts)";
  // Held back, it takes 2.5 s on any machine.
  const Outcome outcome = troupe_on_terminal({"run", "room.world", "--for", "5", "--rate", "2"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("of 5.0 s"));
  EXPECT_THAT(outcome.err, HasSubstr("[====="));
  EXPECT_THAT(outcome.err, HasSubstr("x real time"));
  EXPECT_THAT(outcome.err, HasSubstr("left"));
  EXPECT_THAT(outcome.err, ::testing::EndsWith("\r\x1b[K"));
}

TEST_F(Run, ProgressStaysAwayFromFilesAndQuietRuns) {
  if (!has_terminals()) GTEST_SKIP() << "the system has no pseudo-terminals (/dev/pts)";
  const std::vector<std::string> slow = {"run", "room.world", "--for", "5", "--rate", "2"};
  EXPECT_THAT(troupe(slow).err, IsEmpty());
  std::vector<std::string> quiet = slow;
  quiet.emplace_back("--quiet");
  EXPECT_THAT(troupe_on_terminal(quiet).err, IsEmpty());
  // A run that is over at once would only flicker.
  EXPECT_THAT(troupe_on_terminal({"run", "room.world", "--for", "0.1"}).err, IsEmpty());
}

TEST(Numbers, HaveFourDigitsForPeople) {
  EXPECT_EQ(four_digits(0), "0");
  EXPECT_EQ(four_digits(0.000123456), "0.0001235");
  EXPECT_EQ(four_digits(1.5), "1.5");
  EXPECT_EQ(four_digits(9999.4), "9999");
  EXPECT_EQ(four_digits(-9999.5), "-10,000");
  EXPECT_EQ(four_digits(12345.6), "12,350");
  EXPECT_EQ(four_digits(-1234567), "-1,235,000");
  EXPECT_EQ(four_digits(2.5e20), "2.5e+20");
  EXPECT_EQ(four_digits(std::nan("")), "nan");
  EXPECT_EQ(grouped(1234567), "1,234,567");
}

TEST_F(Run, WarningsGoToStandardErrorALineEachUnlessQuiet) {
  write("warned.world", "colour \"red\"\n" + std::string(k_room));
  const Outcome outcome = troupe({"run", "warned.world", "--for", "0.1", "--json"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(lines_of(outcome.err), Contains(StartsWith("warned.world:1: warning: ")));
  EXPECT_EQ(lines_of(outcome.out).size(), 1u);
  EXPECT_THAT(troupe({"run", "warned.world", "--for", "0.1", "--quiet"}).err, IsEmpty());
}

TEST_F(Run, RobotsThatNothingMovedAreWarnings) {
  const auto world = [&](const std::string& robots) {
    write("still.json", R"({"troupe": 1, "arena": {"size_m": [4, 4]}, "types": {
"bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}},
"mover": {"extends": "bot", "controller": {"kind": "script", "law": "line"}},
"idler": {"extends": "bot", "controller": {"kind": "script", "legs": [{"until_s": 0.5}]}},
"turner": {"extends": "bot", "controller": {"kind": "script", "legs": [{"until_s": 0.5, "turn_radps": 1}]}},
"post": {"size_m": [0.2, 0.2, 0.2], "controller": {"kind": "rasterize"}}},
"models": [)" + robots + "]}");
    return lines_of(troupe({"run", "still.json", "--for", "1", "--json"}).err);
  };
  const std::string a = R"({"name": "a", "type": "bot", "pose": {"x_m": -1}})";
  const std::string b = R"({"name": "b", "type": "bot", "pose": {"y_m": 1}})";
  const std::string c = R"({"name": "c", "type": "mover"})";
  EXPECT_THAT(world(c), IsEmpty());
  EXPECT_THAT(
      world(a + "," + c),
      ElementsAre("still.json:2: warning: 1 robot of type \"bot\" did not move, because the type has no "
                  "controller that commands it: give the type a controller, or a script with "
                  "--controller"));
  EXPECT_THAT(
      world(a + "," + b),
      ElementsAre(StartsWith("still.json:2: warning: 2 robots of type \"bot\" did not move, because")));
  EXPECT_THAT(
      world(R"({"name": "d", "type": "mover", "pose": {"x_m": 1.88}})"),
      ElementsAre("still.json: warning: no robot moved: the mean displacement is 0 m, and 1 of 1 robot is "
                  "stalled"));
  const std::string e = R"({"name": "e", "type": "idler", "pose": {"x_m": -1}})";
  const std::string f = R"({"name": "f", "type": "turner", "pose": {"y_m": -1}})";
  const std::string g = R"({"name": "g", "type": "post", "pose": {"y_m": 1}})";
  EXPECT_THAT(
      world(c + "," + e),
      ElementsAre(
          "still.json:4: warning: 1 robot of type \"idler\" did not move, because the "
          "controller \"script\" did not command it to move: check the controller and its parameters"));
  EXPECT_THAT(world(c + "," + f + "," + g), IsEmpty()) << "f has turned, and g has no drive";
  EXPECT_THAT(lines_of(troupe({"run", "still.json", "--for", "1", "--quiet"}).err), IsEmpty());
  for (const char* end_s : {"0", "0.1"})
    EXPECT_THAT(lines_of(troupe({"run", "still.json", "--for", end_s, "--json"}).err), IsEmpty()) << end_s;
}

TEST_F(Run, TheSnapshotIsAPngOfTheSizeThatWasAskedFor) {
  const Outcome outcome =
      troupe({"run", "room.world", "--for", "0.3", "--quiet", "--snapshot", "room.png", "--size", "320x200"});
  if (lacks_pictures(outcome)) GTEST_SKIP() << "no pictures here: " << outcome.err;
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(files(), ElementsAre("room.png", "room.world"));
  const std::string png = read("room.png");
  ASSERT_GT(png.size(), 24u);
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(png.substr(16, 8), std::string({0, 0, 1, 64, 0, 0, 0, static_cast<char>(200)}));  // big-endian
}

class RunSession : public Run {
 protected:
  /// The first line of a session of room.world.
  std::string header() {
    EXPECT_EQ(troupe({"run", "room.world", "--for", "0.1", "--hash-log", "first.log"}).code, 0);
    nlohmann::json header{{"troupe_session", 1}, {"tick", 0}, {"hash", ticks("first.log")[0].substr(2, 16)}};
    for (const std::string& line : lines_of(read("first.log"))) {
      const auto colon = line.find(": ");
      if (!line.starts_with("# ") || colon == line.npos) continue;
      const std::string key = line.substr(2, colon - 2);
      (key == "version" ? header : header["options"])[key] = line.substr(colon + 2);
    }
    return header.dump() + "\n";
  }
};

/// As after a kill of the view: its options give no end of the run, and room.world has no quit_time.
TEST_F(RunSession, ThatDoesNotStateItsEndEndsAfterTheLastAction) {
  const std::string move = R"({"tick":4,"n":1,"do":"speed","robot":"position:0","speed":[0.1,0,0]})"
                           "\n";
  const std::string first = header();
  const auto ends = [&](const std::string& lines, const std::string& time_s, const std::string& warning) {
    write("s.jsonl", first + lines);
    const Outcome outcome = troupe({"run", "room.world", "--session", "s.jsonl", "--hash-log", "h.log"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, warning +
                               "s.jsonl: warning: the session does not state when it ended, because its "
                               "program was killed: the run ends after the last action, at " +
                               time_s + " s; --for gives another end\n");
    EXPECT_EQ(ticks("h.log").size(), 1 + static_cast<std::size_t>(std::lround(10 * std::stod(time_s))));
  };
  ends(move, "0.5", "");
  ends("", "0", "");
  ends(move + R"({"tick":9,"n":2,"do":"spe)", "0.5",
       "s.jsonl:3: warning: the last line is incomplete and is skipped\n");
}

TEST_F(RunSession, EndsWithinTheLimitsOfARun) {
  const std::string first = header();
  const auto error_of = [&](const std::string& line) {
    write("s.jsonl", first + line + "\n");
    const Outcome outcome = troupe({"run", "room.world", "--session", "s.jsonl"});
    EXPECT_EQ(outcome.code, 2);
    return outcome.err;
  };
  EXPECT_EQ(error_of(R"({"tick":1000000000000000000,"n":1,"do":"end"})"),
            "s.jsonl:2: error: \"tick\" must be at most 1000000000000000, found 1000000000000000000\n");
  EXPECT_EQ(error_of(R"({"tick":1000000000000000,"n":1,"do":"end"})"),
            "s.jsonl:2: error: tick 1000000000000000 is at 1e+14 s, but a run ends at 1000000000000 s or "
            "earlier\n");
}

TEST_F(RunSession, ThatCannotBeRepeatedIsAFailureAfterItsFirstTicks) {
  write("s.jsonl", header() + R"({"tick":2,"n":1,"do":"release","robot":"r99"})" + "\n");
  const Outcome outcome =
      troupe({"run", "room.world", "--for", "1", "--session", "s.jsonl", "--hash-log", "h.log"});
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  EXPECT_THAT(outcome.err, StartsWith("s.jsonl:2: error: at tick 2: "));
  EXPECT_EQ(ticks("h.log").size(), 3u);
}

TEST_F(Run, FilesThatTheWorldReadsAreNotReplaced) {
  const std::string image = std::string("P5 3 3 255\n") + std::string(9, '\0');
  const std::vector<std::pair<std::string, std::string>> inputs{
      {"plan.pgm", image},
      {"map.pgm", image},
      {"map.yaml", "image: map.pgm\nresolution: 1\norigin: [5, 5, 0]\n"},
      {"types.json", R"({"types": {"box": {"size_m": [1, 1, 1]}}})"},
      {"w.json", R"({"troupe": 1, "include": ["types.json"], "floorplans": [
          {"name": "plan", "bitmap": "plan.pgm", "size_m": [3, 3, 1]}, {"name": "map", "bitmap": "map.yaml"}]})"},
  };
  for (const auto& [name, text] : inputs) write(name, text);
  const std::vector<std::string> before = files();
  for (const auto& [name, text] : inputs) {
    for (const std::string option : {"--hash-log", "--events"}) {
      const Outcome outcome = troupe({"run", "w.json", "--quiet", "--for", "1", option, name});
      EXPECT_EQ(outcome.code, 2);
      EXPECT_THAT(outcome.err,
                  MatchesRegex(name + ": error: cannot be written: it is (the world|a file of the world), "
                                      "which this command reads: choose another file name\n"));
    }
    EXPECT_EQ(read(name), text);
  }
  EXPECT_EQ(files(), before);
}

TEST_F(Run, HardLinksAreTheFilesThatTheyLinkTo) {
  std::filesystem::create_hard_link(path("room.world"), path("link"));
  const Outcome outcome = troupe({"run", "room.world", "--for", "1", "--hash-log", "link"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("link: error: cannot be written: it is the world"));
  EXPECT_EQ(read("room.world"), k_room);
}

TEST_F(Run, OutputsThatCannotBeWrittenAreRefusedBeforeTheRun) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"--hash-log", "none/h.log"}, "none/h.log: error: cannot be written: there is no folder none"},
      {{"--snapshot", "none/p.png"}, "none/p.png: error: cannot be written: there is no folder none"},
      {{"--hash-log", "/"}, "/: error: cannot be written: it is a folder"},
      {{"--hash-log", "./room.world"},
       "./room.world: error: cannot be written: it is the world, which this command reads: choose another "
       "file name"},
      {{"--hash-log", "p.png", "--snapshot", "./p.png"},
       "./p.png: error: cannot be written: another output has the same name: choose another file name"},
  };
  for (const auto& [options, message] : cases) {
    std::vector<std::string> arguments{"run", "room.world", "--for", "1"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = troupe(arguments);
    EXPECT_EQ(outcome.code, 2) << message;
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_THAT(lines_of(outcome.err), ElementsAre(message));
    EXPECT_THAT(files(), ElementsAre("room.world"));
  }
  EXPECT_EQ(read("room.world"), k_room);
}

TEST_F(Run, OutputsThatBecomeOneFileAreRefusedBeforeTheRun) {
  write("room.json", R"({"troupe": 1, "record": {"file": "kept.h5"}})");
  std::filesystem::create_directory(path("fr"));
  std::filesystem::create_symlink("t1.csv", path("t2.csv"));  // the file t1.csv does not exist
  std::filesystem::create_symlink("t2.csv", path("t3.csv"));
  std::filesystem::create_symlink("k.h5", path("link.h5"));
  const std::vector<std::string> before = files();
  const std::string k_same =
      ": error: cannot be written: another output has the same name: choose another "
      "file name";
  const auto partial = [](const std::string& name, const std::string& of) {
    return name + ": error: cannot be written: another output, " + of +
           ", uses this name for a temporary file: choose another file name";
  };
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"room.world", "--measures", "t1.csv", "--events", "t2.csv"}, "t2.csv" + k_same},
      {{"room.world", "--measures", "t3.csv", "--events", "t1.csv"}, "t1.csv" + k_same},
      {{"room.world", "--record", "link.h5", "--checkpoint", "k.h5"}, "link.h5" + k_same},
      {{"room.world", "--record", "k.h5.partial", "--checkpoint", "k.h5"}, partial("k.h5.partial", "k.h5")},
      {{"room.world", "--record", "k.h5.2.partial", "--checkpoint", "link.h5"},
       partial("k.h5.2.partial", "link.h5")},
      {{"room.world", "--measures", "k.h5.partial.rehearsal", "--checkpoint", "k.h5"},
       partial("k.h5.partial.rehearsal", "k.h5")},
      {{"room.world", "--hash-log", "k.h5.partial.rehearsal.partial", "--checkpoint", "k.h5"},
       partial("k.h5.partial.rehearsal.partial", "k.h5")},
      {{"room.json", "--checkpoint", "kept.h5"}, "kept.h5" + k_same},
      {{"room.json", "--hash-log", "kept.h5.partial"}, partial("kept.h5.partial", "kept.h5")},
      {{"room.world", "--film", "fr/%06d.png", "--snapshot", "fr/000001.png"}, "fr/%06d.png" + k_same},
      {{"room.world", "--film", "fr/%06d.png", "--hash-log", "fr/000001.png.partial"},
       partial("fr/000001.png.partial", "fr/%06d.png")},
  };
  for (const auto& [options, message] : cases) {
    std::vector<std::string> arguments{"run", "--for", "1"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = troupe(arguments);
    EXPECT_EQ(outcome.code, 2) << message;
    EXPECT_THAT(lines_of(outcome.err), ElementsAre(message));
    EXPECT_EQ(files(), before);
  }
  EXPECT_EQ(troupe({"run", "room.world", "--for", "1", "--quiet", "--film", "fr/%06d.png", "--snapshot",
                    "fr/00001.png"})
                .code,
            0);
}

TEST_F(Run, AnOutputThatAnotherRunWritesStays) {
  for (const auto& [option, file] : {std::pair<std::string, std::string>("--hash-log", "run.log"),
                                     {"--measures", "m.csv"},
                                     {"--events", "e.csv"},
                                     {"--profile", "p.json"}}) {
    std::vector<std::string> run = {"run", "room.world", "--for", "1", "--quiet", option, file};
    if (option != "--hash-log") run.insert(run.end(), {"--hash-log", "run.log"});
    ASSERT_EQ(troupe(run).code, 0);
    const std::string whole = read(file);
    const std::string log = read("run.log");
    const int other = open(path(file).c_str(), O_RDONLY | O_CLOEXEC);
    ASSERT_EQ(worldio::lock_file(other), worldio::FileLock::taken);
    const Outcome refused = troupe(run);
    close(other);
    EXPECT_EQ(refused.code, 2);
    EXPECT_EQ(refused.err,
              file +
                  ": error: cannot be written: another process is writing the file: choose another file, or "
                  "wait until it ends\n");
    EXPECT_EQ(read("run.log"), log);
    EXPECT_EQ(read(file), whole);
    EXPECT_EQ(troupe(run).code, 0);
  }
}

// A lock needs no right to read.
TEST_F(Run, AnOutputThatMayOnlyBeWrittenIsLocked) {
  write("m.csv", "time_s\n");
  const int other = open(path("m.csv").c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_EQ(worldio::lock_file(other), worldio::FileLock::taken);
  std::filesystem::permissions(path("m.csv"), std::filesystem::perms(0222));
  std::filesystem::permissions(path(""), std::filesystem::perms(0755));
  constexpr uid_t k_user = 65534;
  constexpr int k_unlocked = 1, k_locked = 2;
  const pid_t child = fork();
  if (child == 0) {
    if (geteuid() == 0 && setuid(k_user) != 0) _exit(0);  // root may read all files
    try {
      static_cast<void>(lock_output(path("m.csv")));
      _exit(k_unlocked);
    } catch (const OutputError&) {
      _exit(k_locked);
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  close(other);
  if (WEXITSTATUS(status) == 0) GTEST_SKIP() << "root cannot become another user here";
  EXPECT_EQ(WEXITSTATUS(status), k_locked);
}

TEST_F(Run, TooLittleMemoryIsAnErrorThatSaysSo) {
  if (test::k_slow_build) GTEST_SKIP() << "sanitizers reserve more address space";
  write("million.json", R"({"troupe": 1, "arena": {"size_m": [2000, 2000]},
    "types": {"bot": {"size_m": [0.1, 0.1, 0.1], "drive": {"kind": "diff"}}},
    "populations": [{"name": "r", "type": "bot", "count": 1000000, "place": {"rule": "uniform"}}]})");
  const Outcome outcome =
      troupe_with_memory_limit({"run", "million.json", "--for", "1", "--threads", "1"}, 200'000'000);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err,
            "troupe: error: not enough memory: use fewer robots, outputs or layers, or a machine with more "
            "memory\n");
}

TEST_F(Run, AFullDiskIsAFailureAndNotASuccess) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full here";
  const Outcome outcome = troupe({"run", "room.world", "--for", "1", "--hash-log", "/dev/full"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, StartsWith("/dev/full: error: writing failed at tick 0"));
}

}  // namespace
}  // namespace troupe::apps::run_test
