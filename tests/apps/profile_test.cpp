#include "apps/observers/profile.hpp"
#include "tests/apps/program.hpp"
#include "tests/support/paths.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <csignal>
#include <map>
#include <set>

namespace troupe::apps::profile_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::Pair;
using ::testing::SizeIs;

const std::string k_hospital = (test::source_dir() / "worlds/hospital.json").string();
const std::vector<std::string> k_phase_names{"intervene", "sense", "actuate", "decide", "move", "index"};

struct Event {
  std::string name;
  double begin = 0, end = 0;  // microseconds
  std::size_t track = 0;
  nlohmann::json arguments;
  bool holds(const Event& other) const { return begin <= other.begin + 1e-4 && other.end <= end + 1e-4; }
};

/// Complete events of a trace, by what they are, in the order of the file.
struct Trace {
  explicit Trace(const std::string& text) : json(nlohmann::json::parse(text)) {
    for (const auto& e : json.at("traceEvents")) {
      const std::string kind = e.at("ph");
      if (kind == "C") counters[e.at("name")].push_back(e.at("args").at(e.at("name").get<std::string>()));
      const bool is_of_rank = e.at("pid") == 2;
      if (kind == "M" && e.at("name") == "thread_name")
        (is_of_rank ? ranks : tracks)[e.at("tid")] = e.at("args").at("name");
      if (kind != "X") continue;
      const double begin = e.at("ts");
      const Event event{e.at("name"), begin, begin + e.at("dur").get<double>(), e.at("tid"), e.at("args")};
      (is_of_rank             ? of_ranks
       : event.track > 0      ? tasks
       : event.name == "tick" ? ticks
                              : phases)
          .push_back(event);
    }
  }
  nlohmann::json json;
  std::vector<Event> ticks, phases, tasks, of_ranks;
  std::map<std::string, std::vector<std::uint64_t>> counters;
  std::map<std::size_t, std::string> tracks, ranks;
};

std::vector<int> numbers(const std::vector<Event>& ticks) {
  std::vector<int> out;
  for (const Event& tick : ticks) out.push_back(tick.arguments.at("tick"));
  return out;
}

/// Returns how many of the events lasted at the same time, at most. The threads of a pool may take turns, so
/// this number and not the number of tracks is limited by the number of threads.
int most_at_a_time(const std::vector<Event>& events) {
  std::vector<std::pair<double, int>> changes;
  for (const Event& event : events) {
    changes.emplace_back(event.begin + 1e-4, +1);
    changes.emplace_back(event.end, -1);
  }
  std::ranges::sort(changes);
  int now = 0;
  int most = 0;
  for (const auto& [time, change] : changes) most = std::max(most, now += change);
  return most;
}

class Profiles : public ProgramTest {
 protected:
  Trace trace(std::vector<std::string> options) {
    options.insert(options.begin(),
                   {"run", k_hospital, "--robots", "300", "--profile", "trace.json", "--quiet"});
    const Outcome outcome = troupe(options);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return Trace(read("trace.json"));
  }
};

TEST_F(Profiles, ShowEachRank) {
  troupe({"run", k_hospital, "--robots", "300", "--for", "0.4", "--ranks", "3", "--threads", "1", "--profile",
          "ranks.json", "--quiet"});
  const Trace ranks(read("ranks.json"));
  EXPECT_THAT(numbers(ranks.ticks), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(ranks.ranks,
              ElementsAre(std::pair(0, "rank 0"), std::pair(1, "rank 1"), std::pair(2, "rank 2")));
  ASSERT_THAT(ranks.of_ranks, SizeIs(4 * 3 * 3));
  std::map<int, int> rows;  // by tick
  for (const Event& bar : ranks.of_ranks) {
    EXPECT_THAT(bar.name, ::testing::AnyOf("sense", "actuate", "decide"));
    if (bar.name != "sense") continue;
    EXPECT_GT(bar.end, bar.begin);
    rows[bar.arguments.at("tick")] += bar.arguments.at("rows").get<int>();
  }
  EXPECT_THAT(rows, ElementsAre(std::pair(1, 300), std::pair(2, 300), std::pair(3, 300), std::pair(4, 300)));
  EXPECT_THAT(trace({"--for", "0.2"}).of_ranks, IsEmpty());
}

class ProfilesOf : public Profiles, public ::testing::WithParamInterface<int> {};
INSTANTIATE_TEST_SUITE_P(Threads, ProfilesOf, ::testing::Values(1, 2, 3, 8));

TEST_P(ProfilesOf, ShowEachTickWithItsPhasesAndTasks) {
  const int threads = GetParam();
  const Trace trace = this->trace({"--for", "0.4", "--threads", std::to_string(threads)});
  EXPECT_THAT(numbers(trace.ticks), ElementsAre(1, 2, 3, 4));
  ASSERT_THAT(trace.phases, SizeIs(4 * k_phase_names.size()));
  for (std::size_t i = 0; i < trace.phases.size(); ++i) {
    const Event& phase = trace.phases[i];
    const Event& tick = trace.ticks[i / k_phase_names.size()];
    EXPECT_EQ(phase.name, k_phase_names[i % k_phase_names.size()]);
    EXPECT_EQ(phase.arguments.at("tick"), tick.arguments.at("tick"));
    EXPECT_TRUE(tick.holds(phase)) << i;
    if (i > 0) {
      EXPECT_LE(trace.phases[i - 1].end, phase.begin + 1e-4);
    }
    if (phase.arguments.contains("imbalance")) {
      EXPECT_GE(phase.arguments.at("imbalance"), 1 - 1e-3);
      EXPECT_LE(phase.arguments.at("imbalance"),
                static_cast<double>(std::max<std::size_t>(threads, trace.tracks.size())) + 1e-3);
    }
  }
  EXPECT_TRUE(trace.phases[1].arguments.contains("imbalance"));

  std::map<std::size_t, double> free_from;  // by track
  std::set<int> batches;
  for (const Event& task : trace.tasks) {
    EXPECT_TRUE(std::ranges::any_of(
        trace.phases, [&](const Event& phase) { return phase.name == task.name && phase.holds(task); }))
        << task.name << " at " << task.begin;
    EXPECT_LE(free_from[task.track], task.begin + 1e-4);
    free_from[task.track] = task.end;
    if (task.name == "sense") batches.insert(task.arguments.at("task").get<int>());
    EXPECT_TRUE(trace.tracks.contains(task.track)) << task.track;
  }
  EXPECT_GE(batches.size(), 4u);
  EXPECT_EQ(*batches.rbegin() + 1, static_cast<int>(batches.size()));
  EXPECT_LE(most_at_a_time(trace.tasks), threads);
}

TEST_F(Profiles, CountMemoryAndRobots) {
  Trace trace = this->trace({"--for", "0.3"});
  EXPECT_THAT(trace.counters.at("robots"), ElementsAre(300, 300, 300));
  EXPECT_THAT(trace.counters.at("stalled"), SizeIs(3));
  // At least a pose of four doubles, velocity and command of three each, a byte, twelve floats.
  EXPECT_GE(trace.counters.at("state bytes").back(), 300u * (32 + 24 + 24 + 1 + 48));
  EXPECT_LE(trace.counters.at("state bytes").back(), 300u * 300);
  EXPECT_GT(trace.counters.at("resident bytes").back(), 1u << 20);
  EXPECT_FALSE(trace.json.at("otherData").contains("left_out"));
}

// Counts of robots would need the robots of all ranks after each tick.
TEST_F(Profiles, CountNoDistributedRobots) {
  const Trace trace = this->trace({"--for", "0.3", "--ranks", "2", "--distribute"});
  EXPECT_THAT(trace.counters, ElementsAre(Pair("resident bytes", SizeIs(3))));
  EXPECT_THAT(trace.of_ranks, SizeIs(3 * 2 * 3));
}

TEST_F(Profiles, ShowTheTicksThatWereAskedFor) {
  EXPECT_THAT(numbers(trace({"--for", "1", "--profile-ticks", "3:5"}).ticks), ElementsAre(3, 4, 5));
  EXPECT_THAT(numbers(trace({"--for", "1", "--profile-ticks", "9:99"}).ticks), ElementsAre(9, 10));
  EXPECT_THAT(trace({"--for", "0.1", "--profile-ticks", "7:7"}).ticks, IsEmpty());
}

TEST_F(Profiles, WithoutTheTicksThatWereAskedForAreReported) {
  write("room.world", k_room);
  const auto warning = [&](const std::string& ticks) {
    return troupe({"run", "room.world", "--for", "0.5", "--profile", "trace.json", "--profile-ticks", ticks})
        .err;
  };
  EXPECT_THAT(warning("7:9"), HasSubstr("trace.json: warning: the profile has no tick: --profile-ticks "
                                        "selects the ticks 7 to 9, but the run had the ticks 1 to 5\n"));
  EXPECT_THAT(warning("5:9"), IsEmpty());
}

TEST_F(Profiles, ChangeNoResult) {
  trace({"--for", "0.5", "--hash-log", "with.log"});
  EXPECT_EQ(troupe({"run", k_hospital, "--robots", "300", "--for", "0.5", "--hash-log", "without.log"}).code,
            0);
  EXPECT_EQ(lines_of(read("with.log")), lines_of(read("without.log")));
}

TEST_F(Profiles, AreWholeWhenTheRunIsStopped) {
  write("room.world", k_room);
  const Outcome outcome = troupe_until(
      {"run", "room.world", "--for", "1e6", "--quiet", "--profile", "trace.json", "--hash-log", "h.log"},
      "h.log", 40, SIGINT);
  EXPECT_EQ(outcome.code, 3);
  const Trace trace(read("trace.json"));
  EXPECT_GE(trace.ticks.size(), 20u);
  EXPECT_EQ(trace.phases.size(), trace.ticks.size() * k_phase_names.size());
}

/// A run of ten ticks with a profile of these limits; gives its warning.
std::string limited(const std::string& file, const ProfileLimits& limits, std::size_t& readable) {
  SimulationOptions options;
  options.threads = 2;
  options.robots = {{"", 200}};
  Simulation simulation(k_hospital, options);
  Profile profile(file, simulation, limits);
  simulation.on_phase([&](std::optional<Phase> phase) { profile.phase(phase); });
  simulation.on_task([&](std::size_t task, bool begins) { profile.task(task, begins); });
  for (int i = 0; i < 10; ++i) {
    simulation.step();
    profile.observe(simulation);
    std::ifstream stream(file);
    readable += nlohmann::json::accept(std::string(std::istreambuf_iterator<char>(stream), {}));
  }
  return profile.warning();
}

TEST_F(Profiles, StaySmall) {
  const std::string file = path("limited_trace.json").string();
  const auto read_trace = [&] {
    std::ifstream stream(file);
    return Trace(std::string(std::istreambuf_iterator<char>(stream), {}));
  };
  std::size_t readable = 0;
  EXPECT_THAT(
      limited(file, {.most_tasks = 100, .most_ticks = 7}, readable),
      MatchesRegex(".*: warning: to keep the file small, the profile omits: tasks from tick [3-7] on; "
                   "everything from tick 8 on .--profile-ticks selects the ticks to profile."));
  EXPECT_EQ(readable, 10u);
  const Trace trace = read_trace();
  EXPECT_THAT(trace.ticks, SizeIs(7));
  EXPECT_LE(trace.tasks.size(), 100u);
  EXPECT_GE(trace.tasks.size(), 10u);
  EXPECT_THAT(trace.json.at("otherData").at("left_out").get<std::string>(),
              HasSubstr("everything from tick 8 on"));
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace troupe::apps::profile_test
