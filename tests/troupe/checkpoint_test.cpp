// A resumed run has the same bits as a run that was not interrupted.

#include "worldio/results/checkpoint.hpp"
#include "base/diagnostics.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/world/world.hpp"
#include "tests/support/hash_log.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/registry.hpp"
#include "troupe/troupe.hpp"
#include "worldio/results/hdf5_file.hpp"
#include "worldio/results/sealed_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::checkpoint_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const fs::path k_worlds = test::source_dir() / "worlds";
const fs::path k_stage_styles = test::source_dir() / "tests/troupe/stage_styles";
const fs::path k_stage_worlds = test::source_dir() / ".." / "shared" / "stage-worlds";

void expect_same_statistics(const Statistics& a, const Statistics& b) {
  EXPECT_EQ(a.robots, b.robots);
  EXPECT_EQ(a.ticks, b.ticks);
  EXPECT_EQ(a.time_s, b.time_s);
  EXPECT_EQ(a.beams, b.beams);
  EXPECT_EQ(a.stalled, b.stalled);
  EXPECT_EQ(a.held_at_bounds, b.held_at_bounds);
  EXPECT_EQ(a.mean_displacement_m, b.mean_displacement_m);
  EXPECT_EQ(a.conflict_rounds, b.conflict_rounds);
  EXPECT_EQ(a.state_bytes, b.state_bytes);
}

class Checkpoint : public test::ScratchTest {
 protected:
  void SetUp() override {
    if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  }

  std::string error_of(const fs::path& file, const ResumeOptions& options = {}) const {
    try {
      Simulation::resume(file, options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  fs::path file_ = folder_ / "run.h5";
};

/// A controller that counts its decisions, and the same in a later version, which also keeps its luck.
struct Newer {
  struct Memory {
    std::uint32_t decisions = 0;
    double luck = 1;
    TROUPE_FIELDS(decisions, luck)
  };
  void operator()(Memory& memory, const engine::Percept&, Random&, engine::Actions&) const {
    ++memory.decisions;
  }
};
struct Older {
  struct Memory {
    std::uint32_t decisions = 0;
    TROUPE_FIELDS(decisions)
  };
  void operator()(Memory& memory, const engine::Percept&, Random&, engine::Actions&) const {
    ++memory.decisions;
  }
};

struct Scene {
  std::string name;
  fs::path world;
  SimulationOptions options;
};

std::vector<Scene> all_scenes() {
  std::vector<Scene> all;
  for (const scenes::Run& run : scenes::runs_of("checkpoint")) {
    SimulationOptions options;
    if (const auto& robots = test::k_slow_build ? run.robots_slow : run.robots)
      options.robots = {{"", *robots}};
    if (run.by_grid) options.ranging = RangingEngine::grid;
    all.push_back({run.name(), run.file(), options});
  }
  all.push_back({"flockInStagesSyntax", k_stage_styles / "flock.world", {}});
  all.push_back({"foragersInStagesSyntax", k_stage_styles / "forage.world", {}});
  all.push_back({"blocksInStagesSyntax", k_stage_styles / "blocks.world", {}});
  all.push_back({"stageCave", k_stage_worlds / "benchmark" / "cave.world", {}});
  all.push_back({"stagePioneers", k_stage_worlds / "pioneer_walle.world", {}});
  return all;
}

class CheckpointOf : public Checkpoint, public ::testing::WithParamInterface<Scene> {};
INSTANTIATE_TEST_SUITE_P(World, CheckpointOf, ::testing::ValuesIn(all_scenes()),
                         [](const auto& scene) { return scene.param.name; });

TEST_P(CheckpointOf, GoesOnAsIfTheRunHadNeverStopped) {
  if (!fs::exists(GetParam().world)) GTEST_SKIP() << "Stage's data are not in " << GetParam().world.string();
  const int before = test::k_slow_build ? 3 : 21;
  const int after = test::k_slow_build ? 3 : 25;
  SimulationOptions options = GetParam().options;
  options.threads = 1;
  Simulation straight(GetParam().world, options);
  test::hash_log(straight, before);
  straight.save(file_);
  const std::vector<std::string> expected = test::hash_log(straight, after);

  for (const auto& [threads, tile_m] : {std::pair(1u, 0.0), std::pair(3u, 1.7), std::pair(2u, 45.1)}) {
    Simulation resumed = Simulation::resume(file_, {.threads = threads, .tile_size_m = tile_m});
    EXPECT_EQ(resumed.tick(), static_cast<std::uint64_t>(before));
    EXPECT_EQ(test::hash_log(resumed, after), expected) << threads << " threads, tiles of " << tile_m << " m";
    expect_same_statistics(resumed.statistics(), straight.statistics());
    EXPECT_EQ(resumed.robot_names(), straight.robot_names());
  }
}

/// Robots with odometry: one from the start, one that is added after a second, one that a spawner makes then.
std::string world_of_births(const std::string& odom_error) {
  return R"({"troupe": 1, "at": [{"time_s": 1, "add": {"population": "p", "count": 1, "pose": {"x_m": 3}}}],
 "types": {
  "bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff", "localization": "odom")" +
         odom_error + R"(},
          "controller": {"kind": "script", "legs": [{"until_s": 1000, "forward_mps": 0.3, "turn_radps": 0.1}]}},
  "door": {"size_m": [0.2, 0.2, 0.01], "obstacle": false, "ranger_return": -1,
           "devices": [{"name": "sp", "kind": "spawner", "population": "q", "every_s": 1}]}},
 "models": [{"name": "door", "type": "door", "pose": {"x_m": 6}}],
 "populations": [
  {"name": "p", "type": "bot", "count": 1, "reserve": 1,
   "place": {"rule": "grid", "region_m": [[0, 0], [1, 1]], "pitch_m": 1}},
  {"name": "q", "type": "bot", "count": 0, "reserve": 1,
   "place": {"rule": "grid", "region_m": [[0, 0], [1, 1]], "pitch_m": 1}}]})";
}

TEST_F(Checkpoint, GoesOnWithTheOdometryOfRobotsThatWereBornBeforeIt) {
  for (const char* error : {"", R"(, "odom_error": [0.01, -0.02, 0.03])"}) {
    Simulation straight = Simulation::from_text(world_of_births(error), "births.json");
    test::hash_log(straight, 12);
    ASSERT_EQ(straight.robots(), 3u);
    fs::remove(file_);
    straight.save(file_);
    Simulation resumed = Simulation::resume(file_);
    EXPECT_EQ(test::hash_log(resumed, 30), test::hash_log(straight, 30)) << "odometry" << error;
    const auto off = [&straight](const char* name) {
      const Model robot = straight.find(name);
      return (robot.pose().position() - robot.estimate().position()).norm();
    };
    EXPECT_GT(off("p1"), 1.0) << "its odometry begins at 0, where it was added is elsewhere";
  }
}

TEST_F(Checkpoint, OfTickZeroIsTheWholeRun) {
  Simulation straight(k_worlds / "crowd.json");
  straight.save(file_);
  const auto expected = test::hash_log(straight, 4);
  Simulation resumed = Simulation::resume(file_);
  EXPECT_EQ(resumed.tick(), 0u);
  EXPECT_EQ(test::hash_log(resumed, 4), expected);
}

TEST_F(Checkpoint, SavedAgainIsTheSameFile) {
  Simulation simulation(k_worlds / "crowd.json");
  test::hash_log(simulation, 3);
  simulation.save(file_);
  simulation.save(folder_ / "again.h5");
  EXPECT_EQ(content(file_), content(folder_ / "again.h5"));
  // A chain of resumed runs loses nothing either; the header tells where each was taken up.
  Simulation resumed = Simulation::resume(file_);
  const auto expected = test::hash_log(simulation, 2);
  EXPECT_EQ(test::hash_log(resumed, 2), expected);
  resumed.save(folder_ / "later.h5");
  Simulation third = Simulation::resume(folder_ / "later.h5");
  EXPECT_EQ(test::hash_log(third, 3), test::hash_log(simulation, 3));
}

TEST_F(Checkpoint, ResetGoesBackToTickZero) {
  Simulation simulation(k_worlds / "crowd.json");
  const auto from_the_start = test::hash_log(simulation, 4);
  simulation.save(file_);
  Simulation resumed = Simulation::resume(file_);
  resumed.reset();
  EXPECT_EQ(test::hash_log(resumed, 4), from_the_start);
}

// A sensor and a drive with periods of their own, a sensor that only a program has run, a part with a name.
constexpr std::string_view k_room = R"({
  "troupe": 1, "title": "A room", "quit_time_s": 9, "resolution_m": 0.05,
  "types": {
    "wall": {"size_m": [0.2, 4, 1]},
    "bot": {"size_m": [0.4, 0.3, 0.25], "drive": {"kind": "diff"}, "sensors": [
      {"name": "eye", "kind": "ranger", "active": false, "pose": {"z_m": 0.1}, "period_s": 0.4,
       "transducers": [{"range_max_m": 5}]}]},
    "slow": {"size_m": [0.3, 0.3, 0.25], "drive": {"kind": "omni", "period_s": 0.3}, "sensors": [
      {"name": "eye/0", "kind": "ranger", "period_s": 0.7, "transducers": [{"range_max_m": 3, "samples": 9, "fov_deg": 90}]}],
      "controller": {"kind": "wander"}}
  },
  "models": [
    {"name": "wall", "type": "wall", "pose": {"x_m": 2}},
    {"name": "r0", "type": "bot", "pose": {"heading_deg": 0}},
    {"name": "r1", "type": "bot", "pose": {"y_m": 1, "heading_deg": 0}},
    {"name": "s0", "type": "slow", "pose": {"x_m": -1, "y_m": -1, "heading_deg": 30}},
    {"name": "s1", "type": "slow", "pose": {"x_m": -1, "y_m": 2, "heading_deg": 130}}
  ]
})";

TEST_F(Checkpoint, HoldsSpeedsThatWereSetSubscriptionsAndReadingsBetweenTwoPeriods) {
  Simulation straight(write("room.json", k_room));
  straight.subscribe("r0");
  straight.find("r0").set_speed(0.3, 0.1);
  straight.find("r1").set_speed(-0.2, 0);
  for (int tick = 0; tick < 9; ++tick) {  // whatever phase the periods are in
    test::hash_log(straight, 1);
    straight.save(file_);
    Simulation resumed = Simulation::resume(file_);
    EXPECT_EQ(resumed.find("r0").ranges()[0], straight.find("r0").ranges()[0]);
    EXPECT_THROW(resumed.find("r1").ranges(), std::logic_error) << "it has no subscription";
    Simulation reference = Simulation::resume(file_, {.threads = 1});
    EXPECT_EQ(test::hash_log(resumed, 12), test::hash_log(reference, 12));
  }
  straight.save(file_);
  Simulation resumed = Simulation::resume(file_);
  EXPECT_EQ(resumed.find("r0").speed().forward, straight.find("r0").speed().forward);
  EXPECT_EQ(test::hash_log(resumed, 30), test::hash_log(straight, 30));
  EXPECT_EQ(resumed.title(), "A room");
  EXPECT_EQ(resumed.quit_time_s(), 9);
}

TEST_F(Checkpoint, NeedsNoOtherFile) {
  fs::create_directories(folder_ / "elsewhere");
  for (const char* name : {"cave-simple.json", "cave.png"}) fs::copy_file(k_worlds / name, folder_ / name);
  SimulationOptions few;
  few.robots = {{"", 10}};
  Simulation straight(folder_ / "cave-simple.json", few);
  test::hash_log(straight, 2);
  straight.save(folder_ / "elsewhere" / "run.h5");
  for (const char* name : {"cave-simple.json", "cave.png"}) fs::remove(folder_ / name);
  Simulation resumed = Simulation::resume(folder_ / "elsewhere" / "run.h5");
  EXPECT_EQ(test::hash_log(resumed, 3), test::hash_log(straight, 3));
}

TEST_F(Checkpoint, KeepsTheOptionsOfTheRun) {
  SimulationOptions options;
  options.seed = 77;
  options.set = {{"/types/bot/drive/velocity_max_x_mps", "0.5"}};
  Simulation straight(write("room.json", k_room), options);
  straight.step();
  straight.save(file_);
  const Simulation resumed = Simulation::resume(file_, {.set = {{"/quit_time_s", "20"}}});
  using Option = std::pair<std::string, std::string>;
  EXPECT_THAT(resumed.effective_options(),
              ::testing::IsSupersetOf(
                  {Option("world", (folder_ / "room.json").string()), Option("seed", "77"),
                   Option("robots", "4"), Option("set /types/bot/drive/velocity_max_x_mps", "0.5"),
                   Option("set /quit_time_s at tick 1", "20"), Option("resumed_at_tick", "1")}));
  EXPECT_EQ(resumed.quit_time_s(), 20);
  EXPECT_THAT(resumed.warnings(), ::testing::IsEmpty());
}

TEST_F(Checkpoint, GoesOnOtherwiseWithWhatIsSet) {
  Simulation straight(write("room.json", k_room));
  straight.find("r1").set_speed(-0.5, 0);
  straight.run_for(0.5);
  straight.save(file_);
  const auto seed = [&](const char* value) {
    Simulation resumed = Simulation::resume(file_, {.set = {{"/seed", value}}});
    return test::hash_log(resumed, 40);
  };
  EXPECT_EQ(seed("1"), test::hash_log(straight, 40));
  Simulation slower =
      Simulation::resume(file_, {.set = {{"/types/2/drive/params/velocity_min_x_mps", "-0.1"}}});
  slower.step();
  EXPECT_EQ(slower.find("r1").speed().forward, -0.1);
}

TEST_F(Checkpoint, WithATickThatNoRunReachesIsDamaged) {
  Simulation simulation(write("room.json", k_room));
  engine::World& world = simulation.world();
  std::vector<engine::StateTable> state(world.tables().begin(), world.tables().end());
  const auto fill = [&](std::span<engine::StateTable> tables) {
    for (std::size_t t = 0; t < tables.size(); ++t)
      std::ranges::copy(state[t].data(), tables[t].data().begin());
  };
  constexpr std::uint64_t k_most = 1'000'000'000'000'000;
  for (const std::uint64_t tick : {k_most, k_most + 1, ~std::uint64_t{0}}) {
    ASSERT_TRUE(world.restore(tick, world.counters(), simulation.state_hash(), fill));
    simulation.save(file_);
    if (tick == k_most)
      EXPECT_EQ(Simulation::resume(file_).tick(), tick);
    else
      EXPECT_EQ(error_of(file_),
                fmt::format("{}: error: /meta has the attribute \"tick\" {}, but must have a "
                            "number from 0 to 1000000000000000: the file is damaged",
                            file_.string(), static_cast<std::int64_t>(tick)));
  }
}

// The interventions of the tick have been applied before the callback, and a resumed run would repeat them.
TEST_F(Checkpoint, IsNotSavedInACallbackOfBeforeTick) {
  Simulation simulation(write("room.json", k_room));
  std::string error;
  simulation.before_tick([&](Simulation& s) {
    try {
      s.save(file_);
    } catch (const std::logic_error& refusal) {
      error = refusal.what();
    }
  });
  simulation.step();
  EXPECT_THAT(error, StartsWith("save() is not allowed in a callback of before_tick(), because a run that is "
                                "resumed from the checkpoint would repeat the interventions of this tick"));
  EXPECT_FALSE(fs::exists(file_));
  simulation.before_tick([](Simulation&) { throw std::runtime_error("not today"); });
  EXPECT_THROW(simulation.step(), std::runtime_error);
  simulation.reset();
  simulation.save(file_);
  EXPECT_EQ(Simulation::resume(file_).tick(), 0u);
}

TEST_F(Checkpoint, WhatIsSetReplacesEarlierInterventions) {
  Simulation straight(write("room.json", k_room));
  straight.set("bot", R"({"drive": {"velocity_min_x_mps": -0.4}})");
  straight.find("r1").set_speed(-0.5, 0);
  straight.run_for(0.5);
  EXPECT_EQ(straight.find("r1").speed().forward, -0.4);
  straight.save(file_);
  // The value in the world file, which the earlier change of the run had replaced, and another one.
  for (const double limit : {-0.5, -0.1}) {
    Simulation resumed = Simulation::resume(
        file_, {.set = {{"/types/2/drive/params/velocity_min_x_mps", fmt::format("{}", limit)}}});
    resumed.step();
    EXPECT_EQ(resumed.find("r1").speed().forward, limit);
  }
}

TEST_F(Checkpoint, HoldsWhichChangesOfItsTickAreInForce) {
  Simulation straight = Simulation::from_text(R"({
    "troupe": 1,
    "types": {"bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"},
                      "devices": [{"kind": "power_pack", "name": "pack", "capacity_J": 100, "stored_J": 50}]}},
    "populations": [{"name": "bots", "type": "bot", "count": 2, "reserve": 3,
                     "place": {"rule": "grid", "region_m": [[0, 0], [3, 3]], "pitch_m": 1}}]})",
                                              "bots.json");
  straight.run_for(0.3);
  straight.set("bot", R"({"device": {"name": "pack", "stored_J": 5}})");
  straight.save(file_);
  Simulation resumed = Simulation::resume(file_);
  EXPECT_EQ(resumed.parameters("bot"), straight.parameters("bot"));
  for (Simulation* each : {&straight, &resumed}) {
    each->spawn("bots", {5, 5, 0});
    each->step();
  }
  EXPECT_EQ(resumed.world().hashes().state, straight.world().hashes().state);
}

TEST_F(Checkpoint, RefusesChangesOfTheShapeOfTheState) {
  Simulation straight(write("room.json", k_room));
  straight.save(file_);
  EXPECT_THAT(
      error_of(file_, {.set = {{"/types/3/sensors/0/params/transducers/0/samples", "11"}}}),
      StartsWith(
          "--set /types/3/sensors/0/params/transducers/0/samples: error: device \"eye/0\": \"set\" cannot "
          "change a parameter that determines how many values a device reads or stores"));
  EXPECT_THAT(error_of(file_, {.set = {{"/types/2/drive/params/localization", "odom"}}}),
              StartsWith("--set /types/2/drive/params/localization: error: drive \"diff\": \"localization\" "
                         "cannot change while the world runs"));
  EXPECT_THAT(error_of(file_, {.set = {{"/tick_s", "0.2"}}}), StartsWith("--set /tick_s: error: "));
}

/// Counts its decisions, in a memory of every element type.
struct Counter {
  struct Memory {
    std::uint8_t small = 0;
    std::int64_t count = -1;
    std::array<float, 3> thirds{};
    double last = 0.1;
    TROUPE_FIELDS(small, count, thirds, last)
  };
  std::vector<std::size_t> choose(std::span<const engine::DeviceInfo>, std::vector<bool>&) { return {}; }
  void operator()(Memory& memory, const engine::Percept& percept, Random& random,
                  engine::Actions& actions) const {
    memory.small += 3;
    memory.count *= -2;
    memory.thirds[percept.tick % 3] += 1 / 3.0f;
    memory.last = random.uniform();
    actions.command.x = memory.last / 10;
  }
};

TEST_F(Checkpoint, HoldsTheMemoriesOfControllersThatOnlyTheProgramKnows) {
  const auto registry = [] {
    engine::Registry kinds = make_registry();
    kinds.controllers.push_back(engine::make_controller_kind<Counter>("counter", "counts"));
    return kinds;
  };
  Simulation straight(write("own.json", R"({"troupe": 1,
    "types": {"bot": {"size_m": [0.4, 0.3, 0.25], "drive": {"kind": "diff"}, "controller": {"kind": "counter"}}},
    "models": [{"name": "a", "type": "bot"}, {"name": "b", "type": "bot", "pose": {"x_m": 2}}]})"),
                      {}, registry());
  test::hash_log(straight, 5);
  straight.save(file_);
  Simulation resumed = Simulation::resume(file_, {}, registry());
  EXPECT_EQ(test::hash_log(resumed, 5), test::hash_log(straight, 5));
  EXPECT_THAT(error_of(file_),
              HasSubstr("run.h5: error: /types/1/controllers/0: unknown controller \"counter\""));
}

TEST_F(Checkpoint, OfAnotherVersionIsResumedOnlyWhereThatIsWanted) {
  Simulation simulation(write("room.json", k_room));
  const std::string here = version_line();
  const auto made_by = [&](const std::string& version) {
    worldio::write_checkpoint(file_, simulation.world(), simulation.registry(), {{"version", version}});
  };
  made_by("troupe 0.0.1" + here.substr(here.find(" (")));
  EXPECT_THAT(error_of(file_),
              StartsWith(file_.string() +
                         ": error: troupe 0.0.1 wrote this checkpoint, but this program is troupe "));
  const Simulation resumed = Simulation::resume(file_, {.across_versions = true});
  EXPECT_EQ(resumed.state_hash(), simulation.state_hash());
  EXPECT_THAT(
      resumed.warnings(),
      ::testing::ElementsAre(HasSubstr("run.h5: warning: the checkpoint was written by troupe 0.0.1 (")));

  made_by(here.substr(0, here.find(" (")) + " (another compiler)");
  EXPECT_THAT(Simulation::resume(file_).warnings(),
              ::testing::ElementsAre(
                  HasSubstr("the run continues with the same bits, because results do not depend on")));
}

TEST_F(Checkpoint, AStateThatIsNotTheOneThatWasSavedIsNotTakenUp) {
  Simulation simulation(write("room.json", k_room));
  engine::World& world = simulation.world();
  const std::uint64_t at_start = simulation.state_hash();
  simulation.run_for(0.5);
  EXPECT_FALSE(world.restore(7, {}, 12345, [](std::span<engine::StateTable>) {}));
  EXPECT_EQ(world.tick(), 0u);
  EXPECT_EQ(simulation.state_hash(), at_start);
  simulation.run_for(0.5);
  const auto fails = [](std::span<engine::StateTable>) { throw std::runtime_error("no more"); };
  EXPECT_THROW(world.restore(7, {}, 12345, fails), std::runtime_error);
  EXPECT_EQ(world.tick(), 0u);
  EXPECT_EQ(simulation.state_hash(), at_start);
}

TEST_F(Checkpoint, NamesAFieldThatTheRunDoesNotHave) {
  engine::Registry newer = make_registry();
  newer.controllers.push_back(engine::make_controller_kind<Newer>("counter", "counts"));
  engine::Registry older = make_registry();
  older.controllers.push_back(engine::make_controller_kind<Older>("counter", "counts"));
  const std::string world = R"({"troupe": 1,
    "types": {"bot": {"size_m": [0.4, 0.3, 0.25], "drive": {"kind": "diff"}, "controller": {"kind": "counter"}}},
    "models": [{"name": "a", "type": "bot"}]})";
  Simulation(write("own.json", world), {}, newer).save(file_);
  EXPECT_THAT(test::message_of<InputError>([&] { Simulation::resume(file_, {}, older); }),
              HasSubstr("has the field \"luck\", which this run does not have: resume with the version of "
                        "Troupe and the plug-ins that saved the checkpoint"));
}

TEST_F(Checkpoint, RefusesWhatIsNoCheckpoint) {
  EXPECT_EQ(error_of(folder_ / "no.h5"), (folder_ / "no.h5").string() + ": error: there is no such file");
  EXPECT_THAT(error_of(folder_), HasSubstr(": error: this is a folder"));
  EXPECT_THAT(error_of(write("room.json", k_room)), HasSubstr(": error: this is not a checkpoint"));
  EXPECT_THAT(error_of(write("empty.h5", "")), HasSubstr("this is not a checkpoint: the file is empty"));
  const fs::path other = folder_ / "other.h5";
  worldio::Hdf5File::create(other).close();
  EXPECT_THAT(error_of(other), HasSubstr("this is an HDF5 file, but not a checkpoint"));
}

TEST_F(Checkpoint, RefusesOneThatWasCutOffOrDamagedOrIsNewer) {
  Simulation simulation(write("room.json", k_room));
  test::hash_log(simulation, 2);
  simulation.save(file_);
  const std::string good = content(file_);
  const auto fault_of = [&](const std::string& bytes) { return error_of(write("bad.h5", bytes)); };
  EXPECT_EQ(fault_of(good), "no error");
  for (std::size_t i = 1; i < 16; ++i)
    EXPECT_THAT(fault_of(good.substr(0, good.size() * i / 16)),
                HasSubstr("bad.h5: error: the file was cut off"));
  for (std::size_t i = 0; i < good.size(); i += 1 + good.size() / (test::k_slow_build ? 50 : 500)) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0x10);
    EXPECT_THAT(fault_of(bad), HasSubstr("bad.h5: error: ")) << "byte " << i;
  }
  std::string newer = good;
  newer.replace(newer.find("layout 1"), 8, "layout 2");
  EXPECT_THAT(fault_of(newer),
              HasSubstr("the file has layout 2, that of a newer version of Troupe; this program reads layout "
                        "1"));
}

/// The seal is no secret: a file of unknown origin has one that fits. HDF5 crashed with each of these.
TEST_F(Checkpoint, RefusesWrongStructuresOfHdf5UnderASealThatFits) {
  Simulation simulation(write("room.json", k_room));
  simulation.save(file_);
  const std::string good = content(file_);
  const auto fault_of = [&](const std::string& bytes) {
    worldio::write_sealed(file_, worldio::k_checkpoint_kind, worldio::k_checkpoint_layout,
                          std::as_bytes(std::span(bytes)));
    return error_of(file_);
  };
  EXPECT_EQ(fault_of(good), "no error");
  const auto replace_each = [&](std::string_view head, std::size_t at, std::string_view by,
                                const char* error) {
    std::size_t count = 0;
    for (std::size_t found = good.find(head); found != good.npos;
         found = good.find(head, found + 1), ++count) {
      std::string bad = good;
      bad.replace(found + head.size() + at, by.size(), by);
      EXPECT_THAT(fault_of(bad), AllOf(HasSubstr("run.h5: error: /"), HasSubstr(error))) << "byte " << found;
    }
    EXPECT_GT(count, 5u);
  };
  using namespace std::string_view_literals;
  const std::string_view no_address = "\xff\xff\xff\xff\xff\xff\xff\xff"sv;
  const std::string_view layout = "\x08\0\x18\0\0\0\0\0\3"sv;  // head of a message, and its version
  replace_each(layout, 0, "\0\0\0"sv,
               "is damaged, or Troupe did not write the file: it is not stored contiguously");
  replace_each(layout, 9, "\x01"sv, "is damaged, or Troupe did not write the file: it has ");
  const std::string_view symbol_table = "\x11\0\x10\0\0\0\0\0"sv;
  replace_each(symbol_table, 0, no_address, "is damaged, or Troupe did not write the file: it has ");
  replace_each(symbol_table, 8, no_address, "is damaged, or Troupe did not write the file: it has ");
}

TEST_F(Checkpoint, ThatCannotBeWrittenLeavesTheOneBefore) {
  Simulation simulation(k_worlds / "crowd.json");
  simulation.save(file_);
  const std::string before = content(file_);
  simulation.step();

  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  std::vector<std::string> errors;
  for (const rlim_t bytes :
       {rlim_t{100}, rlim_t{3000}, rlim_t{before.size() / 2}, rlim_t{before.size() - 1}}) {
    const rlimit small{bytes, old.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
    try {
      simulation.save(file_);
      errors.emplace_back("no error");
    } catch (const std::runtime_error& error) {
      errors.emplace_back(error.what());
    }
  }
  setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, old_handler);

  EXPECT_THAT(errors, ::testing::Each(::testing::AllOf(StartsWith(file_.string() + ": error: "),
                                                       HasSubstr("File too large"))));
  EXPECT_EQ(content(file_), before);
  EXPECT_FALSE(fs::exists(file_.string() + ".partial"));
  simulation.save(file_);  // and when there is room again it is written
  EXPECT_EQ(Simulation::resume(file_).state_hash(), simulation.state_hash());
}

TEST_F(Checkpoint, HoldsDataOfProgramsUnderNamesThatTroupeDoesNotUse) {
  Simulation simulation(write("room.json", k_room));
  const auto memory = [] { return std::vector<std::byte>(3, std::byte{7}); };
  simulation.on_save("mine", memory);
  for (const char* name : {"holds", "stop_when", "stop_when 0123456789abcdef"}) {
    try {
      simulation.on_save(name, memory);
      FAIL() << name;
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(error.what(), fmt::format("on_save(): checkpoints store data of Troupe under \"{}\": choose "
                                          "another name",
                                          name));
    }
  }
  simulation.save(file_);
  EXPECT_EQ(Simulation::resume(file_).saved_memory("mine"), memory());
}

TEST_F(Checkpoint, HoldsDataOfProgramsThatAreEmpty) {
  Simulation simulation(write("room.json", k_room));
  simulation.on_save("mine", [] { return std::vector<std::byte>(); });
  simulation.save(file_);
  const Simulation resumed = Simulation::resume(file_);
  EXPECT_EQ(resumed.saved_memory("mine"), std::vector<std::byte>());
  EXPECT_EQ(resumed.saved_memory("yours"), std::nullopt);
  EXPECT_EQ(resumed.state_hash(), simulation.state_hash());
}

TEST_F(Checkpoint, ThatHasNoFolderIsAnError) {
  const Simulation simulation(write("room.json", k_room));
  const std::string error =
      test::message_of<std::runtime_error>([&] { simulation.save(folder_ / "no" / "run.h5"); });
  EXPECT_THAT(error, HasSubstr("there is no folder " + (folder_ / "no").string()));
  EXPECT_THAT(error, StartsWith((folder_ / "no" / "run.h5").string() + ": error: "));
}

}  // namespace
}  // namespace troupe::checkpoint_test
