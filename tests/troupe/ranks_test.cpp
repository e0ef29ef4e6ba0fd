// Several ranks compute a world with the same bits as one rank, whatever the delays and the order of their
// messages are, and whichever robots each rank computes (docs/cluster.md).

#include "base/hash.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/observing/displacement.hpp"
#include "engine/observing/remade_world.hpp"
#include "engine/ranks/sharing.hpp"
#include "engine/world/world.hpp"
#include "models/devices/led.hpp"
#include "partition/mailboxes.hpp"
#include "tests/support/hash_log.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "tests/troupe/golden_hashes.hpp"
#include "troupe/rank_processes.hpp"
#include "troupe/registry.hpp"
#include "troupe/troupe.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>

#include <algorithm>
#include <any>
#include <array>
#include <atomic>
#include <cfenv>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <memory>
#include <new>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

namespace troupe::ranks_test {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;
using ::testing::StartsWith;

/// A number of ranks, of threads per rank, and a seed of delays and owners.
struct Team {
  unsigned ranks = 1;
  unsigned threads = 1;
  std::uint64_t seed = 1;
  bool distribute = false;
};

SimulationOptions options_of(const Team& team, const scenes::Run& run) {
  SimulationOptions options;
  options.threads = team.threads;
  options.ranks = team.ranks;
  options.rank_seed = team.seed;
  options.distribute = team.distribute;
  if (run.by_grid) options.ranging = RangingEngine::grid;
  if (run.robots) options.robots = {{"", *run.robots}};
  return options;
}

std::vector<std::string> log_of(const scenes::Run& run, const Team& team) {
  Simulation simulation(run.file(), options_of(team, run));
  return test::hash_log(simulation, run.ticks);
}

/// Each pair of values of two columns is in a row.
constexpr std::array<Team, 12> k_teams{{{2, 1, 1},
                                        {2, 2, 2},
                                        {2, 1, 3},
                                        {3, 2, 1},
                                        {3, 1, 2},
                                        {3, 2, 3},
                                        {4, 1, 1},
                                        {4, 2, 2},
                                        {4, 1, 3},
                                        {7, 2, 1},
                                        {7, 1, 2},
                                        {7, 2, 3}}};

void expect_golden(const scenes::Run& run, const std::vector<Team>& teams) {
  const std::vector<std::string> expected = log_of(run, {});
  const auto golden = test::golden_hashes();
  ASSERT_THAT(expected.back(), HasSubstr(" " + golden.at(test::golden_run(run)) + " "));
  for (const Team& team : teams) {
    const std::vector<std::string> got = log_of(run, team);
    for (std::size_t tick = 0; tick < expected.size(); ++tick)
      ASSERT_EQ(got[tick], expected[tick])
          << team.ranks << " ranks, " << team.threads << " threads, seed " << team.seed;
  }
}

class Ranks : public ::testing::TestWithParam<scenes::Run> {};

// One team for each world; the worlds together use all of them.
TEST_P(Ranks, GiveTheSameBits) {
  expect_golden(GetParam(), {k_teams[hash_text(GetParam().name()) % k_teams.size()]});
}

// The same, if each rank has only its own robots and those near them. All worlds of the exact ray engine can
// be distributed.
TEST_P(Ranks, GiveTheSameBitsDistributed) {
  Team team = k_teams[hash_text(GetParam().name() + " distributed") % k_teams.size()];
  team.distribute = true;
  const RankStatistics ranks = Simulation(GetParam().file(), options_of(team, GetParam())).rank_statistics();
  ASSERT_EQ(ranks.why_replicated, GetParam().by_grid ? "the world uses the grid ray engine" : "");
  ASSERT_EQ(ranks.is_distributed, !GetParam().by_grid);
  if (GetParam().by_grid) GTEST_SKIP() << "replicated, because " << ranks.why_replicated;
  expect_golden(GetParam(), {team});
}

class RanksOfScene : public ::testing::TestWithParam<scenes::Run> {};

// One team for each number of ranks; scripts/prove runs more.
TEST_P(RanksOfScene, GiveTheSameBits) {
  std::vector<Team> teams;
  for (std::size_t first = 0; first < k_teams.size(); first += 3)
    teams.push_back(k_teams[first + hash_text(GetParam().name()) % 3]);
  expect_golden(GetParam(), teams);
}

std::vector<scenes::Run> runs() {
  return scenes::runs_of(test::k_slow_build ? "same_bits_slow" : "same_bits");
}

INSTANTIATE_TEST_SUITE_P(Worlds, Ranks, ::testing::ValuesIn(runs()),
                         [](const auto& run) { return run.param.name(); });
INSTANTIATE_TEST_SUITE_P(Worlds, RanksOfScene, ::testing::ValuesIn(runs()),
                         [](const auto& run) { return run.param.name(); });

/// A room with wandering robots that have radios and noisy odometry, a gripper, a reserve and faults.
constexpr std::string_view k_wanderers = R"({
  "troupe": 1, "title": "A room", "mortal": true,
  "types": {
    "wall": {"size_m": [0.2, 6.5, 1]},
    "wanderer": {"size_m": [0.31, 0.17, 0.2],
      "drive": {"kind": "diff", "localization": "odom", "odom_error": [0.03, 0.03, 0.05]},
      "controller": {"kind": "wander"}, "sensors": [
      {"name": "eyes", "kind": "ranger", "pose": {"z_m": 0.1}, "transducers": [{"range_max_m": 3.3, "fov_deg": 170.5, "samples": 9}]}]}
  },
  "models": [{"name": "wall", "type": "wall", "pose": {"x_m": 3.7, "heading_deg": 0.7}}],
  "populations": [
    {"name": "w", "type": "wanderer", "count": 40, "reserve": 5,
     "place": {"rule": "uniform", "region_m": [[-3.3, -3.3], [3.3, 3.3]]}}
  ]
})";

class RanksOfAProgram : public test::ScratchTest {
 protected:
  static constexpr std::uint64_t k_ticks = 12;

  Simulation load(unsigned ranks, std::uint64_t seed = 5) const {
    SimulationOptions options;
    options.threads = 2;
    options.ranks = ranks;
    options.rank_seed = seed;
    return Simulation(write("room.json", k_wanderers), options);
  }
  using Program = std::function<void(Simulation& simulation)>;
  /// The hash log of a run whose program changes the world before each tick.
  static std::vector<std::string> log_of(Simulation simulation, const Program& program) {
    std::vector<std::string> lines;
    for (std::uint64_t i = 0; i < k_ticks; ++i) {
      program(simulation);
      lines.push_back(simulation.hash_log_line());
      simulation.step();
      lines.push_back(simulation.hash_log_line());
    }
    return lines;
  }
  void expect_same(const Program& program) const {
    const std::vector<std::string> expected = log_of(load(1), program);
    EXPECT_NE(expected, log_of(load(1), [](Simulation&) {})) << "the program changes nothing";
    EXPECT_EQ(log_of(load(3), program), expected);
    EXPECT_EQ(log_of(load(4, 6), program), expected);
  }
};

TEST_F(RanksOfAProgram, TakeOverItsCommands) {
  expect_same([](Simulation& simulation) {
    simulation.find("w7").set_estimate({0.1, 0.2, 0, 0.3});
    simulation.find("w3").go_to(0.1 * static_cast<double>(simulation.tick()), 1, 0);
  });
}

TEST_F(RanksOfAProgram, TakeOverPlacesBirthsAndDeaths) {
  expect_same([](Simulation& simulation) {
    if (simulation.tick() == 2) simulation.find("w9").set_pose({3.2, 3.2, 0, 1});
    if (simulation.tick() == 3) simulation.remove(simulation.find("w4"));
    if (simulation.tick() == 5) {
      EXPECT_TRUE(simulation.spawn("w", {-5, -5, 0, 0}).has_value());
    }
    if (simulation.tick() == 6) {
      EXPECT_TRUE(simulation.disable(simulation.find("w5")));
    }
    if (simulation.tick() == 8) {
      EXPECT_TRUE(simulation.enable(simulation.find("w5")));
    }
  });
}

TEST_F(RanksOfAProgram, TakeOverWhatItChangesBeforeATick) {
  const auto program = [](Simulation& simulation) {
    simulation.before_tick([](Simulation& now) {
      if (now.tick() % 3 == 0) now.find("w1").set_pose({0.5, 0.01 * static_cast<double>(now.tick()), 0, 1});
      EXPECT_EQ(now.find("w2").ranges().size(), 9u);
    });
  };
  expect_same(program);
}

TEST_F(RanksOfAProgram, TakeOverChangedParameters) {
  const auto setting = [](Simulation& now) {
    if (now.tick() == 3)
      now.set("wanderer", R"({"controller": {"kind": "wander", "cruise_speed_mps": 0.11}})");
    if (now.tick() == 6) now.set("wanderer", R"({"drive": {"velocity_max_x_mps": 0.05}})");
  };
  expect_same(setting);
  expect_same([&](Simulation& simulation) { simulation.before_tick(setting); });
  expect_same([&](Simulation& simulation) {
    setting(simulation);
    if (simulation.tick() == 3) simulation.find("w1").set_pose({0.5, 0.1, 0, 1});
    if (simulation.tick() == 9) simulation.reset();
  });
}

/// Replaces the state of a world by that of another world with the same bodies.
bool restore_from(engine::World& from, engine::World& world) {
  return world.restore(
      from.tick(), from.counters(), from.hashes().state, [&](std::span<engine::StateTable> tables) {
        for (std::size_t t = 0; t < tables.size(); ++t)
          for (std::size_t r = 0; r < tables[t].rows(); ++r) {
            const engine::StateTable& saved = from.tables()[t];
            const std::size_t at = from.view().row_in(saved, from.view().row(tables[t].ids()[r]));
            for (std::size_t f = 0; f < saved.fields().size(); ++f)
              std::memcpy(tables[t].cell<std::byte>(r, f).data(), saved.cell<std::byte>(at, f).data(),
                          saved.fields()[f].bytes());
          }
      });
}

// The callback of before_tick() goes back to an earlier state, and later to tick 0. Interventions are due at
// both ticks: the step with the callback must apply them on all ranks.
TEST_F(RanksOfAProgram, ContinueFromTheStateWithWhichACallbackReplacesTheirs) {
  std::string text(k_wanderers);
  text.insert(text.rfind('}'), R"(, "at": [
    {"time_s": 0, "disable": {"population": "w", "count": 7}},
    {"time_s": 0.2, "set": {"type": "wanderer", "drive": {"velocity_max_x_mps": 0.05}}},
    {"time_s": 0.2, "enable": {"population": "w", "count": 5}},
    {"time_s": 0.4, "remove": {"population": "w", "count": 9}}])");
  const fs::path file = write("changes.json", text);
  const auto load_team = [&](const Team& team) {
    SimulationOptions options;
    options.threads = team.threads;
    options.ranks = team.ranks;
    options.rank_seed = team.seed;
    options.distribute = team.distribute;
    return Simulation(file, options);
  };
  constexpr std::uint64_t k_kept = 2;
  constexpr std::uint64_t k_last = 6;
  const auto line_of = [](const Simulation& simulation) {
    return simulation.hash_log_line() + " beams " + std::to_string(simulation.statistics().beams);
  };
  std::vector<std::string> expected;
  Simulation straight = load_team({});
  for (std::uint64_t tick = 0; tick <= k_last; ++tick) {
    expected.push_back(line_of(straight));
    straight.step();
  }
  for (const Team& team : {Team{}, Team{3, 1, 4, false}, Team{3, 1, 4, true}}) {
    Simulation simulation = load_team(team);
    std::unique_ptr<engine::World> kept;
    const auto step_to = [&](std::uint64_t end) {
      while (simulation.tick() < end) {
        if (simulation.tick() == k_kept && !kept)
          kept = engine::remade_world(simulation.world(), simulation.registry(), {.threads = 1});
        simulation.step();
        EXPECT_EQ(line_of(simulation), expected[simulation.tick()])
            << team.ranks << " ranks, distributed " << team.distribute;
      }
    };
    step_to(k_last);
    bool replaces = true;
    simulation.before_tick([&](Simulation& now) {
      if (std::exchange(replaces, false)) {
        EXPECT_TRUE(restore_from(*kept, now.world()));
      }
    });
    simulation.step();
    EXPECT_EQ(simulation.tick(), k_kept + 1);
    EXPECT_EQ(line_of(simulation), expected[k_kept + 1]);
    step_to(k_last);
    simulation.before_tick([&](Simulation& now) {
      if (now.tick() == k_last) now.world().reset();
    });
    simulation.step();
    EXPECT_EQ(simulation.tick(), 1u);
    EXPECT_EQ(line_of(simulation), expected[1]);
    simulation.before_tick(nullptr);
    step_to(k_last);
  }
}

TEST_F(RanksOfAProgram, StartAgain) {
  expect_same([](Simulation& simulation) {
    if (simulation.tick() == 3) simulation.seed() == 17 ? simulation.reset() : simulation.reset(17);
    simulation.find("w3").set_speed(0.1, 0.2);
  });
}

TEST_F(RanksOfAProgram, ShowEveryReading) {
  Simulation one = load(1);
  Simulation four = load(4);
  for (int i = 0; i < 5; ++i) {
    one.step();
    four.step();
    for (const std::string name : {"w0", "w13", "w20", "w39"}) {
      const std::span<const float> expected = one.find(name).ranges();
      const std::span<const float> got = four.find(name).ranges();
      EXPECT_TRUE(std::ranges::equal(got, expected)) << name;
      EXPECT_EQ(four.find(name).estimate(), one.find(name).estimate()) << name;
    }
    EXPECT_EQ(four.statistics().beams, one.statistics().beams);
    EXPECT_EQ(four.statistics().stalled, one.statistics().stalled);
  }
}

TEST_F(RanksOfAProgram, ResumeWhatOthersSaved) {
  Simulation straight = load(1);
  for (int i = 0; i < 20; ++i) straight.step();
  Simulation saved = load(3);
  for (int i = 0; i < 10; ++i) saved.step();
  const fs::path file = folder_ / "run.h5";
  saved.save(file);
  for (const unsigned ranks : {1u, 2u, 5u}) {
    ResumeOptions options;
    options.threads = 1;
    options.ranks = ranks;
    options.rank_seed = 3;
    Simulation resumed = Simulation::resume(file, options);
    EXPECT_EQ(resumed.ranks(), ranks);
    for (int i = 0; i < 10; ++i) resumed.step();
    EXPECT_EQ(resumed.hash_log_line(), straight.hash_log_line()) << ranks << " ranks";
  }
}

constexpr std::string_view k_rangers = R"({
  "troupe": 1, "title": "A room",
  "types": {
    "wanderer": {"size_m": [0.31, 0.17, 0.2], "drive": {"kind": "diff"}, "controller": {"kind": "wander"}, "sensors": [
      {"name": "eyes", "kind": "ranger", "pose": {"z_m": 0.1}, "transducers": [{"range_max_m": 1.1, "fov_deg": 170.5, "samples": 9}]}]}
  },
  "populations": [{"name": "w", "type": "wanderer", "count": 60, "place": {"rule": "uniform", "region_m": [[-4, -4], [4, 4]]}}]
})";

class DistributedRanks : public test::ScratchTest {
 protected:
  using Counts = std::tuple<std::int64_t, std::int64_t, double>;  // stalled, out of bounds, mean displacement
  static Counts counts_in(const fs::path& checkpoint) {
    const auto file = worldio::Hdf5File::open(checkpoint);
    const worldio::Hdf5Group meta = file.group("meta");
    return {meta.integer("stalled"), meta.integer("held_at_bounds"), meta.number("mean_displacement_m")};
  }
  static Counts counts_of(const Simulation& simulation) {
    const engine::World& world = simulation.world();
    return {static_cast<std::int64_t>(world.view().counts().stalled),
            static_cast<std::int64_t>(world.view().counts().out_of_bounds), engine::mean_displacement(world)};
  }
};

TEST_F(DistributedRanks, ResumeWhatOthersSaved) {
  const fs::path world = write("rangers.json", k_rangers);
  const fs::path file = folder_ / "run.h5";
  SimulationOptions one;
  one.threads = 1;
  Simulation straight(world, one);
  for (int i = 0; i < 20; ++i) straight.step();
  SimulationOptions options = one;
  options.ranks = 3;
  options.rank_seed = 3;
  options.tile_size_m = 1;
  options.distribute = true;
  Simulation saved(world, options);
  EXPECT_TRUE(saved.rank_statistics().is_distributed);
  Simulation straight_at_10(world, one);
  for (int i = 0; i < 10; ++i) {
    saved.step();
    straight_at_10.step();
  }
  saved.save(file);
  EXPECT_EQ(counts_in(file), counts_of(straight_at_10));
  for (const unsigned ranks : {1u, 2u, 5u}) {
    ResumeOptions resume;
    resume.threads = 1;
    resume.ranks = ranks;
    resume.distribute = true;
    Simulation resumed = Simulation::resume(file, resume);
    EXPECT_EQ(resumed.rank_statistics().is_distributed, ranks > 1);
    for (int i = 0; i < 10; ++i) resumed.step();
    EXPECT_EQ(resumed.hash_log_line(), straight.hash_log_line()) << ranks << " ranks";
  }
}

// The compasses run only because the program has subscribed to the sensors of all robots. Rank 0 lacks most
// of the robots.
TEST_F(DistributedRanks, RunTheSensorsToWhichAProgramHasSubscribed) {
  constexpr std::size_t k_robots = 60;
  std::string text(k_rangers);
  constexpr std::string_view k_sensors = R"("sensors": [)";
  text.insert(text.find(k_sensors) + k_sensors.size(),
              R"({"name": "north", "kind": "compass", "active": false}, )");
  const fs::path world = write("rangers.json", text);
  const fs::path file = folder_ / "run.h5";
  const auto subscribe = [](Simulation& simulation) {
    for (std::size_t i = 0; i < k_robots; ++i) simulation.subscribe("w" + std::to_string(i));
  };
  SimulationOptions options;
  options.threads = 1;
  Simulation without(world, options);
  Simulation one(world, options);
  subscribe(one);
  one.save(file);
  const std::vector<std::string> expected = test::hash_log(one, 10);
  EXPECT_NE(test::hash_log(without, 10), expected);
  ResumeOptions resume;
  resume.threads = 1;
  for (const unsigned ranks : {2u, 5u}) {
    options.ranks = resume.ranks = ranks;
    options.tile_size_m = resume.tile_size_m = 1;
    options.distribute = resume.distribute = true;
    Simulation several(world, options);
    EXPECT_TRUE(several.rank_statistics().is_distributed);
    subscribe(several);
    EXPECT_EQ(test::hash_log(several, 10), expected) << ranks << " ranks";
    Simulation resumed = Simulation::resume(file, resume);
    EXPECT_TRUE(resumed.rank_statistics().is_distributed);
    EXPECT_EQ(test::hash_log(resumed, 10), expected) << ranks << " ranks, resumed";
  }
}

/// Saves a run of k_rangers, with an intervention `set` at 0.5 s, after 10 ticks, and resumes it on several
/// ranks.
class RanksThatResume : public DistributedRanks {
 protected:
  static constexpr std::uint64_t k_ticks = 10;

  void save(std::string_view drive, std::string_view drive_at_half_a_second) const {
    std::string text(k_rangers);
    constexpr std::string_view k_drive = R"({"kind": "diff"})";
    text.replace(text.find(k_drive), k_drive.size(), drive);
    text.insert(text.rfind('}'),
                std::string(R"(, "at": [{"time_s": 0.5, "set": {"type": "wanderer", "drive": )") +
                    std::string(drive_at_half_a_second) + "}}]");
    SimulationOptions options;
    options.threads = 1;
    Simulation simulation(write("rangers.json", text), options);
    for (std::uint64_t i = 0; i < k_ticks; ++i) simulation.step();
    simulation.save(file_);
  }
  Simulation resume(const Team& team, const std::vector<std::pair<std::string, std::string>>& set) const {
    ResumeOptions options;
    options.threads = team.threads;
    options.ranks = team.ranks;
    options.rank_seed = team.seed;
    options.distribute = team.distribute;
    options.set = set;
    return Simulation::resume(file_, options);
  }
  /// The JSON pointer of a parameter of the drive of the wanderers, for ResumeOptions::set.
  std::string pointer(std::string_view parameter) const {
    const Simulation simulation = Simulation::resume(file_);
    const std::vector<engine::TypeSpec>& types = simulation.world().spec().types;
    const auto type = std::ranges::find(types, "wanderer", &engine::TypeSpec::name);
    return "/types/" + std::to_string(type - types.begin()) + "/drive/params/" + std::string(parameter);
  }
  using Program = std::function<void(Simulation& simulation)>;
  std::vector<std::string> log_of(Simulation simulation, const Program& program) const {
    program(simulation);
    std::vector<std::string> lines = test::hash_log(simulation, k_ticks);
    lines.push_back(simulation.parameters("wanderer"));
    return lines;
  }
  void expect_same(const std::vector<std::pair<std::string, std::string>>& set,
                   const Program& program) const {
    const std::vector<std::string> expected = log_of(resume({}, set), program);
    EXPECT_NE(expected, log_of(resume({}, {}), [](Simulation&) {})) << "the settings change nothing";
    for (const bool distribute : {false, true})
      for (const Team& team : {Team{2, 1, 3, distribute}, Team{3, 1, 4, distribute}}) {
        Simulation resumed = resume(team, set);
        EXPECT_EQ(resumed.rank_statistics().is_distributed, distribute);
        EXPECT_EQ(log_of(std::move(resumed), program), expected) << team.ranks << " ranks, " << distribute;
      }
  }

  const fs::path file_ = folder_ / "run.h5";
};

constexpr std::string_view k_slower = R"({"drive": {"velocity_max_x_mps": 0.02}})";

TEST_F(RanksThatResume, SetAParameterThatAnEarlierInterventionHasSet) {
  save(R"({"kind": "diff"})", R"({"velocity_max_x_mps": 0.05})");
  const std::vector<std::pair<std::string, std::string>> slower{{pointer("velocity_max_x_mps"), "0.02"}};
  expect_same(slower, [](Simulation&) {});
  expect_same({}, [](Simulation& simulation) { simulation.set("wanderer", k_slower); });
  expect_same(slower, [](Simulation& simulation) {
    simulation.find("w3").set_pose({4.5, 4.5, 0, 1});
    simulation.set("wanderer", R"({"drive": {"velocity_max_x_mps": 0.07}})");
    static_cast<void>(simulation.rank_counts());
    simulation.set("wanderer", R"({"drive": {"velocity_max_x_mps": 0.03}})");
  });
}

TEST_F(RanksThatResume, SetAParameterThatIsValidOnlyAfterAnEarlierIntervention) {
  save(R"({"kind": "diff", "velocity_max_x_mps": 0.03})", R"({"velocity_max_x_mps": 0.06})");
  expect_same({{pointer("velocity_min_x_mps"), "0.05"}}, [](Simulation&) {});
}

// The settings of the run, and those of the resumed run, are gone at tick 0 of a reset.
TEST_F(RanksThatResume, ForgetTheirSettingsWithAReset) {
  save(R"({"kind": "diff"})", R"({"velocity_max_x_mps": 0.05})");
  expect_same({}, [](Simulation& simulation) {
    simulation.set("wanderer", k_slower);
    simulation.reset();
  });
}

// A program may keep spans and references across steps, which another rank computes or must learn of.
TEST_F(RanksOfAProgram, ShowNewStateThroughOldReferences) {
  constexpr std::string_view k_lamps = R"({
  "troupe": 1,
  "types": {"r": {"size_m": [0.3, 0.2, 0.2], "drive": {"kind": "diff"}, "controller": {"kind": "wander"},
    "sensors": [{"name": "eyes", "kind": "ranger", "pose": {"z_m": 0.1}, "transducers": [{"range_max_m": 3, "fov_deg": 170, "samples": 9}]}],
    "devices": [{"name": "lamp", "kind": "led"}]}},
  "populations": [{"name": "r", "type": "r", "count": 20, "place": {"rule": "uniform", "region_m": [[-3, -3], [3, 3]]}}]
})";
  struct Held {
    Simulation simulation;
    std::span<const float> ranges;
    models::LedCommand* lamp;
  };
  const fs::path file = write("lamps.json", k_lamps);
  const auto hold = [&](unsigned ranks) {
    SimulationOptions options;
    options.threads = 1;
    options.ranks = ranks;
    return Simulation(file, options);
  };
  const auto held = [](Simulation simulation) {
    const std::span<const float> ranges = simulation.find("r19").ranges();
    models::LedCommand* lamp = &simulation.find("r19").command<models::LedCommand>();
    return Held{std::move(simulation), ranges, lamp};
  };
  Held one = held(hold(1));
  Held three = held(hold(3));
  for (int tick = 0; tick < 20; ++tick) {
    for (Held* each : {&one, &three}) {
      if (tick == 12) each->simulation.reset();
      each->lamp->shows = true;
      each->lamp->red = 0.01F * static_cast<float>(tick);
      each->simulation.step();
    }
    ASSERT_TRUE(std::ranges::equal(three.ranges, one.ranges)) << tick;
    ASSERT_EQ(three.simulation.hash_log_line(), one.simulation.hash_log_line()) << tick;
  }
}

// Three stores give energy to a robot whose pack cannot take all of it: the order of the effects decides
// which of them gives how much.
TEST(RanksOfAWorld, ApplyEffectsInOneOrder) {
  const fs::path world = test::source_dir() / "tests/planted/rank_effect_order.json";
  const auto log = [&](unsigned ranks, std::uint64_t seed) {
    SimulationOptions options;
    options.threads = 1;
    options.ranks = ranks;
    options.rank_seed = seed;
    Simulation simulation(world, options);
    std::vector<std::string> lines;
    for (int tick = 0; tick < 20; ++tick) {
      simulation.step();
      lines.push_back(simulation.hash_log_line());
    }
    std::vector<double> given;
    for (const char* name : {"a", "b", "c"}) given.push_back(simulation.find(name).energy()->given_j);
    return std::pair(lines, given);
  };
  const auto expected = log(1, 0);
  EXPECT_GT(expected.second[0], expected.second[2]) << "the stores do not compete";
  for (const std::uint64_t seed : {1, 2, 3}) {
    EXPECT_EQ(log(2, seed), expected);
    EXPECT_EQ(log(3, seed), expected);
  }
}

/// The clocks of the ranks, which advance by their own step in each call.
struct Clocks {
  explicit Clocks(std::vector<double> steps) : steps_s(std::move(steps)), now_s(steps_s.size(), 0) {}
  double operator()(unsigned rank) { return now_s[rank] += steps_s[rank]; }
  std::vector<double> steps_s, now_s;
};

// Rank 0 seems to take three times as long as rank 1, whatever it computes: in each cut it loses robots.
TEST_F(RanksOfAProgram, GetRobotsAsTheirTimesSay) {
  Clocks clocks({3, 1});
  SimulationOptions options;
  options.threads = 1;
  options.ranks = 2;
  options.rank_clock = [&](unsigned rank) { return clocks(rank); };
  const fs::path file = write("room.json", k_wanderers);
  Simulation two(file, options);
  Simulation one(file, {});
  const auto rows = [&] { return two.rank_work()[0].rows; };
  two.step();
  one.step();
  const std::uint64_t half = rows();
  EXPECT_EQ(half, two.world().view().rows() / 2);
  EXPECT_EQ(two.rank_work()[1].rows, two.world().view().rows() - half);
  EXPECT_DOUBLE_EQ(two.rank_work()[0].sense_s, 3 * two.rank_work()[1].sense_s);
  for (int tick = 2; tick <= 33; ++tick) {
    two.step();
    one.step();
    ASSERT_EQ(two.hash_log_line(), one.hash_log_line()) << tick;
  }
  EXPECT_EQ(two.rank_statistics().rebalanced, 1u);
  EXPECT_NEAR(static_cast<double>(rows()), 2.0 / 3 * static_cast<double>(half), 1);
  for (int tick = 34; tick <= 65; ++tick) {
    two.step();
    one.step();
  }
  EXPECT_EQ(two.hash_log_line(), one.hash_log_line());
  EXPECT_EQ(two.rank_statistics().rebalanced, 2u);
  EXPECT_LT(rows(), half / 2 + 1);
}

TEST_F(RanksOfAProgram, KeepTheirRobotsIfTheirTimesAreEqual) {
  Clocks clocks({1, 1.05, 1});
  SimulationOptions options;
  options.threads = 1;
  options.ranks = 3;
  options.rank_clock = [&](unsigned rank) { return clocks(rank); };
  Simulation simulation(write("room.json", k_wanderers), options);
  for (int tick = 0; tick < 70; ++tick) simulation.step();
  EXPECT_EQ(simulation.rank_statistics().rebalanced, 0u);
  EXPECT_GT(simulation.rank_statistics().waited_s, 0);
}

TEST_F(RanksOfAProgram, KeepTheirRobotsIfAClockRunsBackwards) {
  Clocks clocks({0, -1});
  SimulationOptions options;
  options.threads = 1;
  options.ranks = 2;
  options.rank_clock = [&](unsigned rank) { return clocks(rank); };
  Simulation simulation(write("room.json", k_wanderers), options);
  for (int tick = 0; tick < 40; ++tick) simulation.step();
  EXPECT_EQ(simulation.rank_statistics().rebalanced, 0u);
}

// A library may have changed the arithmetic of a process, for example that of MPI.
TEST_F(RanksOfAProgram, RestoreTheArithmeticOfTheirProcesses) {
  std::string text(k_wanderers);
  text.insert(text.find("\"localization\""), "\"velocity_max_x_mps\": 0.3, ");
  const fs::path file = write("room.json", text);
  const auto line_after = [&file](std::shared_ptr<RankProcesses> processes) {
    SimulationOptions options;
    options.threads = 1;
    options.processes = std::move(processes);
    Simulation simulation(file, options);
    for (std::uint64_t tick = 0; tick < k_ticks; ++tick) simulation.step();
    return simulation.hash_log_line();
  };
  const std::string expected = line_after(nullptr);
  partition::Mailboxes mailboxes(2);
  std::thread other([&mailboxes] {  // stands for the process of rank 1
    std::fesetround(FE_UPWARD);
    RankProcesses(mailboxes.of(1), 1, 1).follow({}, {});
  });
  EXPECT_EQ(line_after(std::make_shared<RankProcesses>(mailboxes.of(0), 1, 1)), expected);
  other.join();
}

std::string step_error(Simulation& simulation) {
  try {
    simulation.step();
  } catch (const engine::StepError& error) {
    return error.what();
  }
  return "no error";
}

// Two robots have a wrong command. The error names the one with the lower id, whichever ranks own them.
TEST_F(RanksOfAProgram, ReportTheErrorOfOneProcess) {
  const auto spoil = [](Simulation& simulation) {
    simulation.step();
    for (const char* name : {"w31", "w17"}) {
      simulation.world().set_command(simulation.world().view().row(simulation.find(name).id()),
                                     {k_nan, 0, 0});
    }
  };
  Simulation one = load(1);
  spoil(one);
  const std::string expected = step_error(one);
  EXPECT_THAT(expected, HasSubstr("robot \"w17\" was commanded a speed that is not a finite number"));
  for (const unsigned ranks : {2u, 3u, 7u}) {
    Simulation several = load(ranks);
    spoil(several);
    EXPECT_EQ(step_error(several), expected);
    EXPECT_THROW(several.step(), std::logic_error);
    several.reset();
    one.reset();
    several.step();
    one.step();
    EXPECT_EQ(several.hash_log_line(), one.hash_log_line());
  }
}

TEST_F(RanksOfAProgram, GoOnAfterAnExceptionOfItsCallback) {
  Simulation one = load(1);
  Simulation three = load(3);
  for (Simulation* simulation : {&one, &three}) {
    simulation->step();
    simulation->before_tick([](Simulation&) { throw std::runtime_error("not today"); });
    EXPECT_THROW(simulation->step(), std::runtime_error);
    simulation->before_tick(nullptr);
    simulation->reset();
    simulation->step();
  }
  EXPECT_EQ(three.hash_log_line(), one.hash_log_line());
}

/// The ranks on which the hook of UnluckyLed throws.
enum class Unlucky { no, all, other_ranks };

/// The kind `led`, whose hook `start` can throw on all ranks or on all ranks but 0.
struct UnluckyLed {
  static inline std::atomic<Unlucky> throws = Unlucky::no;
  static inline std::thread::id rank_0;
  static inline decltype(engine::DeviceKind::start) start = nullptr;

  static engine::Registry registry() {
    engine::Registry registry = make_registry();
    engine::DeviceKind& led = *std::ranges::find(registry.devices, "led", &engine::DeviceKind::name);
    rank_0 = std::this_thread::get_id();
    start = led.start;
    led.start = [](const std::any& data, engine::StateTable& state, std::size_t slot) {
      if (throws == Unlucky::all || (throws == Unlucky::other_ranks && std::this_thread::get_id() != rank_0))
        throw std::runtime_error("dark");
      if (start != nullptr) start(data, state, slot);
    };
    return registry;
  }
};

class RanksOfLeds : public RanksOfAProgram {
 protected:
  Simulation load(unsigned ranks, const std::string& more = {},
                  const engine::Registry& registry = UnluckyLed::registry()) const {
    std::string text(k_wanderers);
    text.insert(text.find(R"("controller")"), R"("devices": [{"name": "lamp", "kind": "led"}], )");
    text.insert(text.rfind('}'), more);
    SimulationOptions options;
    options.threads = 1;
    options.ranks = ranks;
    return Simulation(write("leds.json", text), options, registry);
  }
};

TEST_F(RanksOfLeds, GoOnAfterAResetThatThrows) {
  Simulation one = load(1);
  Simulation three = load(3);
  for (Simulation* simulation : {&one, &three}) {
    simulation->step();
    UnluckyLed::throws = Unlucky::all;
    EXPECT_THROW(simulation->reset(), engine::StepError);
    static_cast<void>(simulation->rank_counts());  // the other ranks answer after they have tried to reset
    UnluckyLed::throws = Unlucky::no;
    simulation->reset();
    simulation->step();
  }
  EXPECT_EQ(three.hash_log_line(), one.hash_log_line());
}

TEST_F(RanksOfAProgram, GoOnAfterARestartThatTheGridRefuses) {
  std::string text(k_wanderers);
  text.insert(1, R"("ranging": "grid", )");
  const std::filesystem::path file = write("grid.json", text);
  SimulationOptions options;
  options.threads = 1;
  Simulation one(file, options);
  options.ranks = 3;
  Simulation three(file, options);
  for (Simulation* simulation : {&one, &three}) {
    engine::World& world = simulation->world();
    simulation->step();
    std::vector<engine::BodySpec> bodies = world.spec().bodies;
    bodies[world.state().names.find("wall").index()].pose_world_body.x = 2e7;
    EXPECT_THROW(world.restart(7, bodies, simulation->registry()), InputError);
    static_cast<void>(simulation->rank_counts());  // the other ranks answer after they have tried to restart
    simulation->step();
  }
  EXPECT_EQ(three.hash_log_line(), one.hash_log_line());
}

/// The kind `led`, whose hook `bind_world` rejects worlds with a body far away, on all ranks or on all ranks
/// but 0.
struct PickyLed {
  static inline std::atomic<Unlucky> rejects = Unlucky::all;
  static inline std::thread::id rank_0;

  static engine::Registry registry() {
    engine::Registry registry = make_registry();
    rank_0 = std::this_thread::get_id();
    std::ranges::find(registry.devices, "led", &engine::DeviceKind::name)->bind_world =
        [](std::any&, const engine::WorldSpec& spec) -> Result<> {
      const bool is_far = std::ranges::any_of(
          spec.bodies, [](const engine::BodySpec& body) { return body.pose_world_body.x > 1000; });
      if (is_far && (rejects == Unlucky::all || std::this_thread::get_id() != rank_0))
        return Error{"is too far from home"};
      return {};
    };
    return registry;
  }
  /// Restarts the simulation with the robot w0 far away. Returns the error; empty if there is none.
  static std::string restart_far_away(Simulation& simulation) {
    engine::World& world = simulation.world();
    std::vector<engine::BodySpec> bodies = world.spec().bodies;
    bodies[world.state().names.find("w0").index()].pose_world_body.x = 2000;
    try {
      world.restart(7, bodies, simulation.registry());
    } catch (const std::logic_error& error) {
      return error.what();
    }
    return {};
  }
};

TEST_F(RanksOfLeds, GoOnAfterARestartThatAKindRejects) {
  PickyLed::rejects = Unlucky::all;
  Simulation one = load(1, {}, PickyLed::registry());
  Simulation three = load(3, {}, PickyLed::registry());
  for (Simulation* simulation : {&one, &three}) {
    simulation->step();
    EXPECT_THAT(PickyLed::restart_far_away(*simulation), HasSubstr("is too far from home"));
    static_cast<void>(simulation->rank_counts());  // the other ranks answer after they have tried to restart
    simulation->step();
  }
  EXPECT_EQ(three.hash_log_line(), one.hash_log_line());
}

TEST_F(RanksOfLeds, EndAfterARestartThatOnlyOneRankRejects) {
  PickyLed::rejects = Unlucky::other_ranks;
  Simulation simulation = load(2, {}, PickyLed::registry());
  simulation.step();
  EXPECT_EQ(PickyLed::restart_far_away(simulation), "");
  const std::string error = test::message_of<std::exception>([&] { simulation.step(); });
  EXPECT_THAT(error, HasSubstr("rank 1 failed: an error that did not occur on rank 0"));
  EXPECT_THAT(error, HasSubstr("is too far from home"));
}

// The callback of rank 0 reads data of the ranks that have already failed in this tick.
TEST_F(RanksOfLeds, ReportAnErrorThatOtherRanksHadBeforeTheCallback) {
  const std::string more =
      R"(, "at": [{"time_s": 0.2, "add": {"population": "w", "count": 3, "region_m": [[-3, -3], [3, 3]]}}])";
  Simulation one = load(1, more);
  Simulation three = load(3, more);
  std::size_t calls = 0;
  three.before_tick([&](Simulation& simulation) {
    EXPECT_FALSE(simulation.hash_log_line().empty());
    ++calls;
  });
  three.step();
  three.step();
  UnluckyLed::throws = Unlucky::other_ranks;
  EXPECT_THAT(step_error(three), HasSubstr("threw: dark"));
  UnluckyLed::throws = Unlucky::no;
  EXPECT_EQ(calls, 3u);
  three.reset();
  for (int tick = 0; tick < 4; ++tick) {
    one.step();
    three.step();
    EXPECT_EQ(three.hash_log_line(), one.hash_log_line());
  }
}

// The callback of rank 0 resets the world while the other ranks, which have already failed, wait for rank 0.
TEST_F(RanksOfLeds, FollowAResetAfterTheyHaveFailed) {
  const std::string more =
      R"(, "at": [{"time_s": 0.2, "add": {"population": "w", "count": 3, "region_m": [[-3, -3], [3, 3]]}}])";
  Simulation one = load(1, more);
  Simulation three = load(3, more);
  three.before_tick([](Simulation& simulation) {
    EXPECT_FALSE(simulation.hash_log_line().empty()) << "the other ranks answer after they have failed";
    if (UnluckyLed::throws.exchange(Unlucky::no) != Unlucky::no) simulation.world().reset();
  });
  three.step();
  three.step();
  UnluckyLed::throws = Unlucky::other_ranks;
  EXPECT_THAT(step_error(three), HasSubstr("threw: dark"));
  three.reset();
  for (int tick = 0; tick < 4; ++tick) {
    one.step();
    three.step();
    EXPECT_EQ(three.hash_log_line(), one.hash_log_line());
  }
}

TEST_F(RanksOfLeds, ReportAnErrorWithoutAText) {
  engine::Registry registry = make_registry();
  engine::DeviceKind& led = *std::ranges::find(registry.devices, "led", &engine::DeviceKind::name);
  led.act = [](const engine::DeviceBatch&) { throw engine::StepError(""); };
  for (const unsigned ranks : {1u, 3u}) {
    Simulation simulation = load(ranks, {}, registry);
    EXPECT_EQ(step_error(simulation), "") << ranks;
  }
}

// In a replicated world, hooks that the phase move calls run on all ranks. If a hook throws on one rank only,
// the ranks end in the next tick, with its error.
TEST_F(RanksOfLeds, NameAnErrorThatOnlyOneRankHad) {
  engine::Registry registry = UnluckyLed::registry();
  engine::DeviceKind& led = *std::ranges::find(registry.devices, "led", &engine::DeviceKind::name);
  led.scope = engine::ApplyScope::trees;
  static const auto prepare = led.prepare;
  led.prepare = [](const engine::Record& params, const Pose& pose) {
    engine::DeviceKind::Prepared prepared = prepare(params, pose);
    prepared.most_effects = 1;
    return prepared;
  };
  led.act = [](const engine::DeviceBatch& batch) {
    for (std::size_t i = 0; i < batch.rows.size(); ++i) batch.emit(i, 0, 0, batch.body(i));
  };
  led.apply = [](const engine::EffectContext&, const std::any&, const engine::Effect&) {
    if (UnluckyLed::throws == Unlucky::other_ranks && std::this_thread::get_id() != UnluckyLed::rank_0)
      throw std::runtime_error("dark");
  };
  Simulation simulation = load(2, {}, registry);
  simulation.step();
  static_cast<void>(simulation.rank_counts());  // rank 1 answers after it has ended the tick
  UnluckyLed::throws = Unlucky::other_ranks;
  try {
    simulation.step();
    simulation.step();
    ADD_FAILURE();
  } catch (const std::exception& error) {
    EXPECT_THAT(error.what(), HasSubstr("rank 1 failed: an error that did not occur on rank 0"));
    EXPECT_THAT(error.what(), HasSubstr("tick 2: device \"lamp\" (led) of \"w"));
  }
  UnluckyLed::throws = Unlucky::no;
}

TEST_F(RanksOfAProgram, EndIfTheyCannotBeMade) {
  SimulationOptions options;
  options.threads = 1;
  options.ranks = 3;
  options.rank_clock = [](unsigned rank) -> double {
    return rank == 0 ? throw std::runtime_error("no clock") : 0.0;
  };
  const fs::path file = write("room.json", k_wanderers);
  EXPECT_THROW(Simulation(file, options), std::runtime_error);
}

/// While it exists, no thread can be started: its stack would not fit into the address space.
class NoFurtherThread {
 public:
  NoFurtherThread() {
    pthread_attr_t none{};
    pthread_attr_init(&none);
    pthread_attr_setstacksize(&none, std::size_t{1} << 60);
    pthread_getattr_default_np(&usual_);
    pthread_setattr_default_np(&none);
    pthread_attr_destroy(&none);
  }
  ~NoFurtherThread() {
    pthread_setattr_default_np(&usual_);
    pthread_attr_destroy(&usual_);
  }
  NoFurtherThread(const NoFurtherThread&) = delete;
  NoFurtherThread& operator=(const NoFurtherThread&) = delete;

 private:
  pthread_attr_t usual_{};
};

TEST_F(RanksOfAProgram, SayThatTheSystemAllowsTooFewThreads) {
  SimulationOptions options;
  options.ranks = 3;
  const fs::path file = write("room.json", k_wanderers);
  for (const auto& [threads, begin] :
       {std::pair(1u, "3 ranks with 1 thread each: "), std::pair(4u, "3 ranks with 4 threads each: ")}) {
    options.threads = threads;
    try {
      const NoFurtherThread limit;
      Simulation(file, options);
      ADD_FAILURE();
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), StartsWith(std::string(begin) + "the system allows too few threads ("));
      EXPECT_THAT(error.what(),
                  HasSubstr("use fewer ranks or threads, or raise the limits on threads and memory"));
    }
  }
}

TEST_F(RanksOfAProgram, SayWhichOfThemHasNotEnoughMemory) {
  SimulationOptions options;
  options.threads = 1;
  options.ranks = 3;
  options.rank_clock = [](unsigned rank) -> double { return rank == 1 ? throw std::bad_alloc() : 0.0; };
  try {
    Simulation simulation(write("room.json", k_wanderers), options);  // may already throw
    simulation.step();
    ADD_FAILURE();
  } catch (const std::exception& error) {
    EXPECT_THAT(error.what(), HasSubstr("rank 1 failed: not enough memory"));
  }
}

TEST_F(RanksOfAProgram, AreOneTo1024) {
  for (const unsigned ranks : {0u, 1025u}) {
    try {
      load(ranks);
      ADD_FAILURE() << ranks;
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(std::string(error.what()), std::to_string(ranks) + " ranks: must be 1 to 1024");
    }
  }
}

TEST_F(RanksOfAProgram, AreOneIfALauncherStartedSeveralProcesses) {
  setenv("OMPI_COMM_WORLD_RANK", "0", 1);
  setenv("OMPI_COMM_WORLD_SIZE", "3", 1);
  EXPECT_EQ(load(1).ranks(), 1u);
  EXPECT_EQ(test::message_of<std::invalid_argument>([&] { load(2); }),
            "2 ranks: the ranks of a program are threads of one process, but mpirun of Open MPI started 3 "
            "processes: start the program without the launcher, or use troupe run, whose ranks may be "
            "processes");
  setenv("OMPI_COMM_WORLD_SIZE", "1", 1);
  EXPECT_EQ(load(2).ranks(), 2u);
  unsetenv("OMPI_COMM_WORLD_RANK");
  unsetenv("OMPI_COMM_WORLD_SIZE");
}

// mpirun of MPICH may run in a step of one process of a Slurm job: `srun --mpi=pmix -n 1 script`.
TEST_F(RanksOfAProgram, AreOneIfALauncherInASlurmStepStartedSeveralProcesses) {
  const std::array<std::pair<const char*, const char*>, 4> variables{
      {{"PMIX_RANK", "0"}, {"SLURM_STEP_NUM_TASKS", "1"}, {"PMI_RANK", "1"}, {"PMI_SIZE", "3"}}};
  for (const auto& [name, value] : variables) setenv(name, value, 1);
  EXPECT_THAT(test::message_of<std::invalid_argument>([&] { load(2); }),
              HasSubstr("mpirun of MPICH started 3 processes"));
  unsetenv("PMI_SIZE");
  EXPECT_EQ(load(2).ranks(), 2u) << "srun started one process";
  for (const auto& [name, value] : variables) unsetenv(name);
}

/// A controller that throws for one robot.
struct Fails {
  static constexpr bool needs_drive = true;
  std::vector<std::size_t> choose(std::span<const engine::DeviceInfo>, std::vector<bool>&) const {
    return {};
  }
  void operator()(const engine::Percept& percept, Random&, engine::Actions&) const {
    if (percept.tick == 3 && percept.body % 10 == 6) throw std::runtime_error("lost");
  }
};

TEST_F(RanksOfAProgram, ReportAControllerThatThrows) {
  engine::Registry kinds = make_registry();
  kinds.controllers.push_back(engine::make_controller_kind<Fails>("fails", "throws"));
  std::string text(k_wanderers);
  text.replace(text.find("\"wander\""), 8, "\"fails\"");
  const fs::path file = write("fails.json", text);
  SimulationOptions options;
  options.threads = 1;
  options.ranks = 4;
  Simulation simulation(file, options, kinds);
  simulation.step();
  simulation.step();
  EXPECT_THAT(step_error(simulation), StartsWith("tick 3: controller \"fails\" of \"w"));
}

TEST_F(RanksOfAProgram, TakeOverWhatItChangesAfterAFailedTick) {
  engine::Registry kinds = make_registry();
  kinds.controllers.push_back(engine::make_controller_kind<Fails>("fails", "throws"));
  std::string text(k_wanderers);
  text.replace(text.find("\"wander\""), 8, "\"fails\"");
  const fs::path file = write("fails.json", text);
  const auto line_after = [&](unsigned ranks) {
    SimulationOptions options;
    options.threads = 1;
    options.ranks = ranks;
    Simulation simulation(file, options, kinds);
    simulation.step();
    simulation.step();
    EXPECT_NE(step_error(simulation), "");
    simulation.reset();
    Model robot = simulation.find("w39");  // its rank is not 0
    Pose pose = robot.pose();
    pose.heading += 1;
    robot.set_pose(pose);
    simulation.step();
    return simulation.hash_log_line();
  };
  EXPECT_EQ(line_after(4), line_after(1));
}

/// A collective controller: every robot turns by the mean of what the rangers of all of them read. It throws
/// in tick `k_throws`.
template <std::uint64_t k_throws>
struct Choir {
  struct Memory {
    double mean = 0;
    TROUPE_FIELDS(mean)
  };
  static constexpr bool needs_drive = true;

  void operator()(const engine::DecideBatch& batch) const {
    if (batch.tick == k_throws) throw std::runtime_error("hoarse");
    double sum = 0;
    for (std::size_t i = 0; i < batch.size(); ++i)
      sum += batch.percepts[0]->cell<double>(batch.slot(i), 0)[4];
    for (std::size_t i = 0; i < batch.size(); ++i) {
      auto& memory = *reinterpret_cast<Memory*>(batch.memory(i));
      memory.mean = 0.5 * (memory.mean + sum / static_cast<double>(batch.size()));
      batch.command(i) = {0.1, 0, memory.mean - 1};
    }
  }
};

template <class C>
Simulation load_collective(const fs::path& file, unsigned ranks) {
  engine::Registry kinds = make_registry();
  kinds.controllers.push_back(engine::make_controller_kind<C>("choir", "sings"));
  kinds.controllers.back().is_collective = true;
  SimulationOptions options;
  options.threads = 1;
  options.ranks = ranks;
  options.rank_seed = 7;
  return Simulation(file, options, kinds);
}

class CollectiveControllers : public RanksOfAProgram {
 protected:
  fs::path write_world() const {
    std::string text(k_wanderers);
    text.replace(text.find("\"wander\""), 8, "\"choir\"");
    return write("choir.json", text);
  }
};

TEST_F(CollectiveControllers, DecideForTheRobotsOfAllRanks) {
  const fs::path file = write_world();
  const auto nothing = [](Simulation&) {};
  const std::vector<std::string> expected = log_of(load_collective<Choir<0>>(file, 1), nothing);
  EXPECT_NE(expected[5], expected[7]);
  for (const unsigned ranks : {2u, 3u, 7u})
    EXPECT_EQ(log_of(load_collective<Choir<0>>(file, ranks), nothing), expected) << ranks;
}

TEST_F(CollectiveControllers, EndTheTickOfAllRanksIfTheyThrow) {
  Simulation simulation = load_collective<Choir<3>>(write_world(), 4);
  simulation.step();
  simulation.step();
  EXPECT_THAT(step_error(simulation), HasSubstr("controller \"choir\""));
  simulation.reset();
  simulation.step();
}

TEST_F(CollectiveControllers, AreNotCalledIfARankHasFailed) {
  const fs::path file = write_world();
  for (const char* name : {"w2", "w17", "w39"}) {
    Simulation one = load_collective<Choir<0>>(file, 1);
    Simulation several = load_collective<Choir<0>>(file, 4);
    for (Simulation* simulation : {&one, &several}) {
      simulation->step();
      simulation->world().set_command(simulation->world().view().row(simulation->find(name).id()),
                                      {k_nan, 0, 0});
    }
    EXPECT_EQ(step_error(several), step_error(one));
    several.reset();
    one.reset();
    several.step();
    one.step();
    EXPECT_EQ(several.hash_log_line(), one.hash_log_line());
  }
}

/// The names of the tables that have this sharing.
std::vector<std::string> shared(const engine::World& world, engine::Sharing how) {
  std::vector<std::string> names;
  const std::vector<engine::Sharing> sharing = engine::sharing_of(world);
  for (std::size_t t = 0; t < sharing.size(); ++t)
    if (sharing[t] == how) names.push_back(world.tables()[t].component());
  return names;
}

TEST_F(RanksOfAProgram, ShareOnlyWhatOthersRead) {
  const Simulation simulation(write("shares.json", R"({
  "troupe": 1,
  "types": {
    "r": {"size_m": [0.31, 0.17, 0.2], "drive": {"kind": "diff", "localization": "odom"},
      "controller": {"kind": "wander"}, "sensors": [
      {"name": "eyes", "kind": "ranger", "pose": {"z_m": 0.1}, "transducers": [{"range_max_m": 3.3, "fov_deg": 170.5, "samples": 9}]},
      {"name": "talk", "kind": "radio", "range_m": 2}],
      "devices": [{"name": "lamp", "kind": "led"}, {"name": "hand", "kind": "gripper"}]}
  },
  "models": [{"name": "r", "type": "r"}]
})"),
                              {});
  const engine::World& world = simulation.world();
  EXPECT_THAT(shared(world, engine::Sharing::sent),
              ::testing::UnorderedElementsAre("velocity", "radio/talk/command", "led/lamp", "gripper/hand",
                                              "gripper/hand/command"))
      << "no controller switches devices, so no rank reads the commands to the drives of other ranks";
  EXPECT_THAT(shared(world, engine::Sharing::kept),
              ::testing::UnorderedElementsAre("command", "ranger/eyes", "radio/talk", "led/lamp/command",
                                              "wander/0"));
}

}  // namespace
}  // namespace troupe::ranks_test
