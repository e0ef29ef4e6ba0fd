#include "troupe/troupe.hpp"

#include "base/hash.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/world/world.hpp"
#include "partition/simd_target.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/effective_options.hpp"
#include "troupe/frame_data.hpp"
#include "troupe/registry.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>

namespace troupe::simulation_test {
namespace {

namespace fs = std::filesystem;
using test::message_of;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::FloatEq;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::Pair;
using ::testing::StartsWith;

const fs::path k_worlds = test::source_dir() / "worlds";

/// Two robots before a wall, in JSON; and the same kinds of things in Stage's syntax.
constexpr std::string_view k_room_json = R"({
  "troupe": 1, "title": "A room", "seed": 5, "tick_s": 0.2, "quit_time_s": 12,
  "types": {
    "wall": {"size_m": [0.2, 4, 1], "ranger_return": 0.5},
    "bot": {"size_m": [0.4, 0.3, 0.25], "drive": {"kind": "diff"}, "sensors": [
      {"name": "front", "kind": "ranger", "pose": {"z_m": 0.1}, "intensity": true,
       "transducers": [{"range_max_m": 5, "fov_deg": 60, "samples": 3}, {"pose": {"heading_deg": 180}, "range_max_m": 4}]},
      {"name": "top", "kind": "ranger", "pose": {"z_m": 0.2}, "active": false, "transducers": [{"range_max_m": 2.5}]}]},
    "omni": {"size_m": [0.4, 0.4, 0.25], "drive": {"kind": "omni"}}
  },
  "models": [
    {"name": "wall", "type": "wall", "pose": {"x_m": 2}},
    {"name": "r0", "type": "bot"},
    {"name": "slider", "type": "omni", "pose": {"y_m": 3, "heading_deg": 90}}
  ]
})";

constexpr std::string_view k_room_world = R"(
define bot position (
  size [0.4 0.3 0.25]
  ranger( sensor( range [0 5] ) )
  ranger( pose [0.05 0 0 90] sensor( range [0 4] ) )
  ranger( name "eye" pose [0.1 0 0 180] sensor( range [0 3] ) )
)
model( name "wall" pose [2 0 0 0] size [0.2 4 1] )
bot( name "r0" )
bot( name "loner" pose [0 3 0 0] ranger( name "/beacon" pose [0 0 0 90] sensor( range [0 1] ) ) )
)";

constexpr std::string_view k_population_json = R"({
  "troupe": 1,
  "types": {"bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}, "controller": {"kind": "wander"}, "sensors": [
    {"name": "eye", "kind": "ranger", "pose": {"z_m": 0.1}, "transducers": [{"range_max_m": 2, "fov_deg": 90, "samples": 9}]}]}},
  "populations": [
    {"name": "r", "type": "bot", "count": 9, "place": {"rule": "uniform", "region_m": [[-5, -5], [5, 5]]}}
  ]
})";

class SimulationTest : public test::ScratchTest {
 protected:
  Simulation json(const SimulationOptions& options = {}) const {
    return Simulation(write("room.json", k_room_json), options);
  }
  Simulation stage() const { return Simulation(write("room.world", k_room_world)); }
  Simulation population(const SimulationOptions& options = {}) const {
    return Simulation(write("population.json", k_population_json), options);
  }
};

// ---- loading

TEST_F(SimulationTest, LoadErrorsAreListedWithFileAndLine) {
  const fs::path file =
      write("bad.json",
            "{\n  \"troupe\": 1,\n  \"types\": {\n    \"bot\": {\"size_m\": [0.2, 0.2, 0],\n"
            "            \"drive\": {\"kind\": \"hover\"}}\n  }\n}\n");
  const std::string text = message_of<InputError>([&] { Simulation simulation(file); });
  EXPECT_THAT(text, HasSubstr(file.string() + ":4: error: /types/bot/size_m"));
  EXPECT_THAT(text, HasSubstr(file.string() + ":5: error: /types/bot/drive"));
  EXPECT_THAT(text, HasSubstr("hover"));
}

TEST_F(SimulationTest, AFileThatIsNotThereIsAnInputError) {
  const std::string missing = (folder_ / "none.world").string();
  EXPECT_EQ(message_of<InputError>([&] { Simulation simulation(missing); }),
            missing + ": error: there is no such file");
}

/// Turns on the spot.
struct Spinner {
  std::vector<std::size_t> choose(std::span<const engine::DeviceInfo>, std::vector<bool>&) const {
    return {};
  }
  void operator()(const engine::Percept&, Random&, engine::Actions& actions) const {
    actions.command = {0, 0, 0.5};
  }
};

TEST_F(SimulationTest, KindsOfTheCallersOwnStandBesideOurs) {
  const fs::path file = write("spin.json", R"({"troupe": 1, "types": {
    "bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}, "controller": {"kind": "spinner"}}},
    "models": [{"name": "r0", "type": "bot"}]})");
  EXPECT_THAT(message_of<InputError>([&] { Simulation simulation(file); }), HasSubstr("spinner"));
  engine::Registry registry = make_registry();
  registry.controllers.push_back(engine::make_controller_kind<Spinner>("spinner", "turns on the spot"));
  Simulation simulation(file, {}, registry);
  simulation.run_for(0.2);
  EXPECT_EQ(simulation.find("r0").speed().turn, 0.5);
  EXPECT_EQ(simulation.world().tick(), 2u);
}

TEST_F(SimulationTest, ExceptionsOfHooksThatOnlyReadNameTheDevice) {
  const fs::path file = write("w.json", R"({"troupe": 1, "types": {
    "bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}, "devices": [{"name": "s", "kind": "sullen"}]}},
    "models": [{"name": "r0", "type": "bot"}]})");
  engine::DeviceKind sullen{.name = "sullen", .text = ""};
  sullen.prepare = [](const engine::Record&, const Pose&) { return engine::DeviceKind::Prepared{.data = 0}; };
  sullen.act = [](const engine::DeviceBatch&) {};  // else it would be a sensor
  sullen.energy = [](const engine::StateTable&, std::size_t) -> engine::Energy {
    throw std::runtime_error("no energy");
  };
  sullen.flags = [](const engine::StateTable&, std::size_t) -> engine::HeldFlags {
    throw std::runtime_error("no flags");
  };
  sullen.layer = engine::FrameLayer::grips;
  sullen.draw = [](const engine::DeviceView&, engine::Frame&) { throw std::runtime_error("no drawing"); };
  engine::Registry registry = make_registry();
  registry.devices.push_back(sullen);
  Simulation simulation(file, {}, registry);
  simulation.step();
  const Model robot = simulation.find("r0");
  constexpr std::string_view k_start = "tick 1: device \"s\" (sullen) of \"r0\" threw: ";
  const auto text = [&](std::string_view what) { return std::string(k_start) + std::string(what); };
  EXPECT_EQ(message_of<std::runtime_error>([&] { robot.energy(); }), text("no energy"));
  EXPECT_EQ(message_of<std::runtime_error>([&] { simulation.energy(); }), text("no energy"));
  EXPECT_EQ(message_of<std::runtime_error>([&] { robot.flag_count(); }), text("no flags"));
  engine::Frame frame;
  frame.mobile.push_back({.id = robot.id().value});
  EXPECT_EQ(message_of<std::runtime_error>([&] { add_charges(simulation.world(), frame); }),
            text("no energy"));
  EXPECT_EQ(message_of<std::runtime_error>(
                [&] { add_layer(simulation.world(), engine::FrameLayer::grips, frame); }),
            text("no drawing"));
}

TEST_F(SimulationTest, WhatTheLoaderWarnsOfIsKept) {
  const fs::path file =
      write("odd.world", "position( name \"r0\" )\nposition( name \"r1\" pose [0 1 0 0] blobs 3 )\n");
  const Simulation simulation(file);
  EXPECT_THAT(simulation.warnings(),
              Contains(AllOf(StartsWith(file.string() + ":2: warning: "), HasSubstr("blobs"))));
}

TEST_F(SimulationTest, TellsAboutItsWorld) {
  const Simulation simulation = json();
  EXPECT_EQ(simulation.title(), "A room");
  EXPECT_EQ(simulation.robots(), 2u);
  EXPECT_EQ(simulation.tick(), 0u);
  EXPECT_EQ(simulation.tick_s(), 0.2);
  EXPECT_EQ(simulation.quit_time_s(), 12);
  EXPECT_THAT(simulation.robot_names(), ElementsAre("r0", "slider"));
  EXPECT_THAT(simulation.warnings(), IsEmpty());
}

TEST_F(SimulationTest, SearchPathFindsWorldsAndWhatTheyInclude) {
  write("inc/parts.inc", "define bot position ( size [0.3 0.3 0.3] )\n");
  write("elsewhere/main.world", "include \"lost/parts.inc\"\nbot( name \"found\" )\n");
  const fs::path lost = folder_ / "lost" / "main.world";
  EXPECT_THROW(Simulation simulation(lost), InputError);
  SimulationOptions options;
  options.search_path = {folder_ / "inc", folder_ / "elsewhere"};
  EXPECT_THAT(Simulation(lost, options).robot_names(), ElementsAre("found"));
}

// ---- options

TEST_F(SimulationTest, EffectiveOptionsSayWhatWasUsed) {
  SimulationOptions options;
  options.threads = 3;
  options.tile_size_m = 6.5;
  options.seed = 99;
  options.set = {{"/tick_s", "0.05"}};
  const Simulation simulation = json(options);
  EXPECT_EQ(simulation.threads(), 3u);
  EXPECT_THAT(
      simulation.effective_options(),
      ElementsAre(Pair("world", (folder_ / "room.json").string()), Pair("seed", "99"), Pair("tick_s", "0.05"),
                  Pair("ranging", "exact"), Pair("robots", "2"), Pair("threads", "3"), Pair("tile_m", "6.5"),
                  Pair("simd", partition::simd_target()), Pair("set /tick_s", "0.05")));
}

TEST_F(SimulationTest, RepeatedSettingsHaveDifferentKeys) {
  SimulationOptions options;
  options.set = {{"/measures", "[]"},
                 {"/tick_s", "0.05"},
                 {"/measures/-", "\"alive\""},
                 {"/measures/-", "\"stalls\""},
                 {"/measures/-", "\"coverage\""},
                 {"/tick_s", "0.02"}};
  const Simulation simulation = json(options);
  auto changes = simulation.effective_options();
  std::erase_if(changes, [](const auto& option) { return !option.first.starts_with("set "); });
  EXPECT_THAT(changes, ElementsAre(Pair("set /measures", "[]"), Pair("set /measures/-", "\"alive\""),
                                   Pair("set /measures/- #2", "\"stalls\""),
                                   Pair("set /measures/- #3", "\"coverage\""), Pair("set /tick_s", "0.02")));
  EXPECT_THAT(simulation.effective_options(), Contains(Pair("tick_s", "0.02")));
}

// The time to number them must not grow with the cube of their count.
TEST_F(SimulationTest, ManyValuesMayBeAppendedToAList) {
  constexpr int k_count = 8000;
  SimulationOptions options;
  for (int i = 0; i < k_count; ++i)
    options.set.emplace_back("/models/-",
                             fmt::format(R"({{"name": "b{0}", "type": "box", "pose": {{"x_m": {0}}}}})", i));
  const Simulation simulation = Simulation::from_text(
      R"({"troupe": 1, "types": {"box": {"size_m": [0.1, 0.1, 0.1]}}, "models": []})", "many.json", options);
  EXPECT_EQ(simulation.world().spec().bodies.size(), 1 + std::size_t{k_count}) << "with the ground";
  EXPECT_THAT(simulation.effective_options(), Contains(Pair("set /models/- #8000", ::testing::_)));
}

TEST_F(SimulationTest, TheRayEngineOfTheWorldHoldsUnlessAnotherIsGiven) {
  SimulationOptions options;
  options.ranging = RangingEngine::grid;
  EXPECT_THAT(json(options).effective_options(),
              AllOf(Contains(Pair("ranging", "grid")), Contains(Pair("resolution_m", "0.02"))));
  options.set = {{"/ranging", "\"grid\""}, {"/resolution_m", "0.1"}};
  options.ranging.reset();
  Simulation coarse = json(options);
  EXPECT_THAT(coarse.effective_options(), Contains(Pair("resolution_m", "0.1")));
  options.ranging = RangingEngine::exact;
  options.set = {{"/resolution_m", "0.1"}};
  Simulation exact = json(options);
  EXPECT_THAT(exact.effective_options(), Contains(Pair("ranging", "exact")));
  coarse.step();
  exact.step();
  EXPECT_NE(coarse.hashes().sensor, exact.hashes().sensor);
  EXPECT_EQ(coarse.hashes().pose, exact.hashes().pose);
}

TEST_F(SimulationTest, TheSeedOfTheWorldHoldsUnlessAnotherIsGiven) {
  EXPECT_THAT(json().effective_options(), Contains(Pair("seed", "5")));
  EXPECT_THAT(population().effective_options(), Contains(Pair("seed", "1")));
  SimulationOptions one;
  one.seed = 1;
  SimulationOptions two;
  two.seed = 2;
  EXPECT_EQ(population().state_hash(), population(one).state_hash());
  EXPECT_NE(population().state_hash(), population(two).state_hash());
}

TEST_F(SimulationTest, RobotsSetsTheSizeOfAPopulation) {
  SimulationOptions options;
  options.robots = {{"", 4}};
  EXPECT_THAT(population(options).robot_names(), ElementsAre("r0", "r1", "r2", "r3"));
  options.robots = {{"r", 2}};
  EXPECT_EQ(population(options).robots(), 2u);
  options.robots = {{"q", 2}};
  EXPECT_THAT(message_of<InputError>([&] { population(options); }), HasSubstr("\"q\""));
}

TEST_F(SimulationTest, SetChangesAValueOfTheWorld) {
  SimulationOptions options;
  options.set = {{"/populations/0/count", "3"}, {"/title", "Other"}};
  const Simulation simulation = population(options);
  EXPECT_EQ(simulation.robots(), 3u);
  EXPECT_EQ(simulation.title(), "Other");
  options.set = {{"/populations/7/count", "3"}};
  EXPECT_THAT(message_of<InputError>([&] { population(options); }), HasSubstr("/populations/7"));
}

TEST_F(SimulationTest, AValueIsGivenByOneOptionOnly) {
  const auto error_of = [&](const SimulationOptions& options) {
    return message_of<InputError>([&] { population(options); });
  };
  EXPECT_THAT(
      error_of({.seed = 7, .set = {{"/seed", "8"}}}),
      HasSubstr("--set /seed: error: has no effect, because --seed gives this value: omit one of them"));
  EXPECT_THAT(error_of({.ranging = RangingEngine::grid, .set = {{"/ranging", "\"exact\""}}}),
              HasSubstr("--set /ranging: error: has no effect, because --raytracer gives this value"));
  for (const char* name : {"", "r"})
    EXPECT_THAT(
        error_of({.robots = {{name, 4}}, .set = {{"/populations/0/count", "3"}}}),
        HasSubstr("--set /populations/0/count: error: has no effect, because --robots gives this value"));
  EXPECT_EQ(population({.seed = 7, .robots = {{"", 4}}, .set = {{"/title", "\"Other\""}}}).robots(), 4u);
}

TEST_F(SimulationTest, ThreadsAndTilesAreNoOptionsOfTheResult) {
  SimulationOptions options;
  options.threads = 4;
  options.tile_size_m = 0.3;
  Simulation a = population();
  Simulation b = population(options);
  a.run_for(2);
  b.run_for(2);
  EXPECT_EQ(a.state_hash(), b.state_hash());
}

// ---- finding

TEST_F(SimulationTest, FindsBodiesAndTheirParts) {
  Simulation simulation = stage();
  EXPECT_EQ(simulation.find("r0").name(), "r0");
  EXPECT_EQ(simulation.find("wall").pose().x, 2);
  EXPECT_EQ(simulation.find("wall").size(), Eigen::Vector3d(0.2, 4, 1));
  const Model side = simulation.find("r0.ranger:1");
  EXPECT_EQ(side.name(), "r0.ranger:1");
  EXPECT_DOUBLE_EQ(side.pose().x, 0.05);
  EXPECT_DOUBLE_EQ(side.pose().z, 0.25);  // on top of its body
  EXPECT_DOUBLE_EQ(side.pose().heading, k_pi / 2);
  EXPECT_DOUBLE_EQ(simulation.find("loner.ranger:1").pose().y, 3);
}

TEST_F(SimulationTest, GeneratedNamesStayValidBesideGivenOnes) {
  Simulation simulation = stage();
  EXPECT_EQ(simulation.find("position:0").pose().y, 0);
  EXPECT_EQ(simulation.find("position:1").pose().y, 3);
  EXPECT_EQ(simulation.find("model:1").pose().x, 2);  // the ground is model:0
  EXPECT_DOUBLE_EQ(simulation.find("r0.eye").pose().x, 0.1);
  EXPECT_DOUBLE_EQ(simulation.find("r0.ranger:2").pose().x, 0.1);
  EXPECT_DOUBLE_EQ(simulation.find("beacon").pose().y, 3);  // a name from the root
}

TEST_F(SimulationTest, HandlesOfOneModelAreEqual) {
  Simulation simulation = stage();
  const Model robot = simulation.find("r0");
  EXPECT_TRUE(simulation.find("position:0") == robot);
  EXPECT_TRUE(simulation.model(robot.id()) == robot);
  EXPECT_FALSE(simulation.find("loner") == robot);
  EXPECT_FALSE(simulation.find("r0.eye") == robot);
  EXPECT_TRUE(simulation.find("r0.eye") == simulation.find("r0.ranger:2"));
  EXPECT_FALSE(stage().find("r0") == robot);
}

TEST_F(SimulationTest, AnUnknownNameIsAnsweredWithANearOne) {
  Simulation simulation = stage();
  const std::string file = (folder_ / "room.world").string();
  const auto find = [&](const char* name) {
    return message_of<std::out_of_range>([&] { simulation.find(name); });
  };
  EXPECT_EQ(find("lonr"), "no model \"lonr\" in " + file + " (did you mean \"loner\"?)");
  EXPECT_EQ(find("r0.ranger:7"), "no model \"r0.ranger:7\" in " + file + " (did you mean \"r0.ranger:0\"?)");
  EXPECT_EQ(find("qwertyuiop"), "no model \"qwertyuiop\" in " + file);
  EXPECT_EQ(find(""), "no model \"\" in " + file);
}

// ---- driving

TEST_F(SimulationTest, ASpeedActsFromTheNextTickOnUntilReplaced) {
  Simulation simulation = json();
  Model robot = simulation.find("r0");
  robot.set_speed(0.5, 0.25);
  EXPECT_EQ(robot.pose().x, 0);
  EXPECT_EQ(robot.speed().forward, 0);
  simulation.step();
  EXPECT_EQ(robot.pose().x, 0.5 * 0.2);
  EXPECT_EQ(robot.pose().heading, 0.25 * 0.2);
  EXPECT_EQ(robot.speed().forward, 0.5);
  EXPECT_EQ(robot.speed().turn, 0.25);
  simulation.step();
  EXPECT_DOUBLE_EQ(robot.pose().heading, 0.1);
  EXPECT_GT(robot.pose().y, 0);
  robot.set_speed(0, 0);
  const Pose at = robot.pose();
  simulation.step();
  EXPECT_EQ(robot.pose(), at);
  EXPECT_EQ(robot.speed().forward, 0);
}

TEST_F(SimulationTest, AnOmniDriveGoesSideways) {
  Simulation simulation = json();
  Model slider = simulation.find("slider");
  slider.set_speed(0, 0.5, 0);
  simulation.step();
  EXPECT_NEAR(slider.pose().x, -0.1, 1e-15);  // its left is -x
  EXPECT_NEAR(slider.pose().y, 3, 1e-15);
  EXPECT_EQ(slider.speed().left, 0.5);
}

TEST_F(SimulationTest, ARobotBeforeAWallIsStalled) {
  Simulation simulation = json();
  Model robot = simulation.find("r0");
  robot.set_speed(1, 0);
  EXPECT_FALSE(robot.stalled());
  simulation.run_for(1.6);
  EXPECT_FALSE(robot.stalled());
  simulation.run_for(0.4);  // its front would reach 2.2 m, the wall begins at 1.9 m
  EXPECT_TRUE(robot.stalled());
  EXPECT_NEAR(robot.pose().x, 1.6, 1e-12);
  EXPECT_EQ(simulation.statistics().stalled, 1u);
  robot.set_speed(-1, 0);
  simulation.step();
  EXPECT_FALSE(robot.stalled());
  EXPECT_EQ(simulation.statistics().stalled, 0u);
}

TEST_F(SimulationTest, WhatHasNoDriveCannotBeDriven) {
  Simulation simulation = json();
  Model wall = simulation.find("wall");
  EXPECT_EQ(message_of<std::logic_error>([&] { wall.set_speed(1, 0); }), "\"wall\" has no drive");
  EXPECT_EQ(message_of<std::logic_error>([&] { static_cast<void>(wall.speed()); }),
            "\"wall\" is static: it has no drive, device or controller and cannot be gripped or pushed, so "
            "it has no motion, command or reading");
  EXPECT_THROW(static_cast<void>(wall.stalled()), std::logic_error);
}

TEST_F(SimulationTest, ASpeedThatIsNoNumberNamesTheRobotAndChangesNothing) {
  Simulation simulation = json();
  simulation.step();
  Model robot = simulation.find("r0");
  EXPECT_EQ(message_of<std::invalid_argument>(
                [&] { robot.set_speed(std::numeric_limits<double>::quiet_NaN(), 0); }),
            "\"r0\" was commanded nan, 0, 0: give finite numbers");
  EXPECT_NO_THROW(simulation.step());
}

// A controller runs once in the period of its first device. The time that a robot waits must not depend on
// it.
TEST_F(SimulationTest, AControllerWaitsForSecondsWithSlowSensorsToo) {
  const auto waiting_ticks = [this](double period_s) {
    const std::string every = R"("period_s": )" + std::to_string(period_s);
    Simulation simulation(write("wait.json", R"({"troupe": 1, "types": {
      "floor": {"size_m": [4, 4, 0.001], "color": "white", "obstacle": false, "ranger_return": -1},
      "robot": {"size_m": [0.07, 0.07, 0.06], "drive": {"kind": "diff"}, "sensors": [
        {"name": "eye", "kind": "ground", )" + every +
                                                 R"(},
        {"name": "radio", "kind": "radio", "pose": {"z_m": 0.05}, "range_m": 0.3, "payload": 1, )" +
                                                 every + R"(},
        {"name": "ir", "kind": "ranger", "pose": {"z_m": 0.04}, )" +
                                                 every + R"(,
         "transducers": [{"range_max_m": 0.2, "fov_deg": 180, "samples": 9}]}],
        "controller": {"kind": "beeclust", "max_wait_s": 20, "min_front_m": 0.001}}},
      "models": [{"name": "floor", "type": "floor"}, {"name": "a", "type": "robot"},
        {"name": "b", "type": "robot", "pose": {"x_m": 0.09, "heading_deg": 180}}]})"));
    const auto waits = [&] {
      const Model::Speed speed = simulation.find("a").speed();
      return speed.forward == 0 && speed.turn == 0;
    };
    for (int tick = 0; tick < 20; ++tick) simulation.step();  // both robots have met
    int ticks = 0;
    for (; waits() && ticks < 2000; ++ticks) simulation.step();
    return ticks;
  };
  const int fast = waiting_ticks(0.1);
  EXPECT_GT(fast, 50);
  EXPECT_LT(fast, 200);
  EXPECT_NEAR(waiting_ticks(0.5), fast, 15);
}

TEST_F(SimulationTest, HandlesOutliveAMoveOfTheSimulation) {
  Simulation first = json();
  Model robot = first.find("r0");
  Simulation second = std::move(first);
  robot.set_speed(0.5, 0);
  second.step();
  EXPECT_EQ(robot.pose().x, 0.1);
}

// ---- sensing

TEST_F(SimulationTest, RangesRunCounterClockwiseAndGoOnWithTheNextTransducer) {
  Simulation simulation = json();
  Model robot = simulation.find("r0");
  EXPECT_THAT(robot.sensors(), ElementsAre("front", "top"));
  const std::span<const float> ranges = robot.ranges();
  simulation.step();
  // The wall's face is 1.9 m ahead and 2 m to each side; nothing behind.
  const auto slanted = static_cast<float>(1.9 / std::cos(k_pi / 6));
  EXPECT_THAT(ranges, ElementsAre(FloatEq(slanted), FloatEq(1.9F), FloatEq(slanted), 4.0F));
  EXPECT_EQ(robot.ranges("front").data(), ranges.data());
  EXPECT_THAT(robot.intensities(), ElementsAre(0.5F, 0.5F, 0.5F, 0.0F));
  robot.set_speed(0.5, 0);
  simulation.run_for(0.4);  // a reading is of the pose before the tick's motion: the same span shows it
  EXPECT_FLOAT_EQ(ranges[1], 1.8F);
}

TEST_F(SimulationTest, ASensorThatDoesNotRunSaysSoUntilSubscribed) {
  Simulation simulation = json();
  Model robot = simulation.find("r0");
  EXPECT_EQ(message_of<std::logic_error>([&] { static_cast<void>(robot.ranges("top")); }),
            "sensor \"top\" of \"r0\" does not run: call subscribe() before the first step");
  simulation.subscribe("r0");
  simulation.step();
  EXPECT_THAT(robot.ranges("top"), ElementsAre(FloatEq(1.9F)));
  EXPECT_THAT(robot.intensities("top"), IsEmpty());  // not switched on
}

TEST_F(SimulationTest, SubscribingToAModelWithoutSensorsChangesNothing) {
  const fs::path file =
      write("wall.world", "model( name \"wall\" size [1 1 1] )\nposition( name \"a\" pose [3 0 0 0] )\n");
  Simulation simulation(file);
  const std::uint64_t before = simulation.state_hash();
  simulation.subscribe("wall");  // it has no row of its own, through which its subscription was written
  simulation.step();
  EXPECT_EQ(simulation.statistics().beams, 0u);
  Simulation other(file);
  EXPECT_EQ(other.state_hash(), before);
  other.step();
  EXPECT_EQ(other.state_hash(), simulation.state_hash());
}

TEST_F(SimulationTest, ASubscriptionRunsTheSensorsOfThatRobotAlone) {
  const fs::path file = write("twins.world",
                              "define bot position ( size [0.4 0.4 0.25] ranger( sensor( range [0 5] ) ) )\n"
                              "bot( name \"a\" )\nbot( name \"b\" pose [3 0 0 0] )\n");
  Simulation simulation(file);
  simulation.subscribe("a");
  simulation.step();
  EXPECT_EQ(simulation.statistics().beams, 1u);
  EXPECT_EQ(simulation.find("a").ranges().size(), 1u);
  EXPECT_THROW(static_cast<void>(simulation.find("b").ranges()), std::logic_error);
}

TEST_F(SimulationTest, SubscriptionsComeBeforeTheFirstStep) {
  Simulation simulation = json();
  simulation.step();
  EXPECT_EQ(message_of<std::logic_error>([&] { simulation.subscribe("r0"); }),
            "subscribe() must be called before the first step, but this simulation is at tick 1");
}

TEST_F(SimulationTest, SubscribingToWhatIsNotThereIsAnError) {
  Simulation simulation = json();
  EXPECT_THROW(simulation.subscribe("r1"), std::out_of_range);
}

TEST_F(SimulationTest, UnknownSensorsAreAnsweredWithTheKnown) {
  Simulation simulation = json();
  EXPECT_EQ(message_of<std::out_of_range>([&] { static_cast<void>(simulation.find("r0").ranges("frnt")); }),
            "\"r0\" has no ranger \"frnt\"; it has: front, top (did you mean \"front\"?)");
  EXPECT_EQ(message_of<std::out_of_range>([&] { static_cast<void>(simulation.find("slider").ranges()); }),
            "\"slider\" has no ranger");
  EXPECT_EQ(message_of<std::out_of_range>([&] { static_cast<void>(simulation.find("wall").intensities()); }),
            "\"wall\" has no ranger");
}

TEST_F(SimulationTest, OtherSensorsHaveNoRanges) {
  Simulation simulation =
      Simulation::from_text(R"({"troupe": 1, "types": {"bot": {"size_m": [0.3, 0.3, 0.2], "sensors": [
      {"name": "needle", "kind": "compass"},
      {"name": "eye", "kind": "ranger", "transducers": [{"range_max_m": 2}]}]}},
    "models": [{"name": "r", "type": "bot"}]})",
                            "w.json");
  simulation.step();
  EXPECT_THAT(simulation.find("r").ranges(), ElementsAre(2.0F));
  EXPECT_EQ(message_of<std::out_of_range>([&] { static_cast<void>(simulation.find("r").ranges("needle")); }),
            "\"r\" has no ranger \"needle\"; it has: eye");
}

TEST_F(SimulationTest, InStageWorldsSensorsRunWhenSubscribed) {
  Simulation simulation = stage();
  EXPECT_THROW(static_cast<void>(simulation.find("r0").ranges()), std::logic_error);
  simulation.subscribe("r0");
  simulation.step();
  EXPECT_THAT(simulation.find("r0").sensors(), ElementsAre("ranger:0", "ranger:1", "eye"));
  EXPECT_THAT(simulation.find("r0").ranges(), ElementsAre(FloatEq(1.9F)));
  EXPECT_EQ(simulation.find("r0").ranges("eye")[0], 3.0F);
  EXPECT_GT(simulation.statistics().beams, 0u);
}

TEST_F(SimulationTest, APartHasItsOwnSensorOnly) {
  Simulation simulation = stage();
  simulation.subscribe("r0");
  simulation.step();
  const Model side = simulation.find("r0.ranger:1");
  EXPECT_THAT(side.sensors(), ElementsAre("ranger:1"));
  const Model robot = simulation.find("r0");
  EXPECT_EQ(side.ranges().size(), 1u);
  EXPECT_EQ(side.ranges().data(), robot.ranges("ranger:1").data());
  EXPECT_NE(side.ranges().data(), robot.ranges().data());
  EXPECT_THROW(static_cast<void>(side.ranges("eye")), std::out_of_range);
}

// ---- time

TEST_F(SimulationTest, RunForRoundsUpToWholeTicks) {
  const auto ticks = [this](double tick_s, double seconds) {
    SimulationOptions options;
    options.set = {{"/tick_s", std::to_string(tick_s)}};
    Simulation simulation = json(options);
    simulation.run_for(seconds);
    return simulation.tick();
  };
  EXPECT_EQ(ticks(0.1, 0.7), 7u);  // 0.7 / 0.1 is 6.999... in binary
  EXPECT_EQ(ticks(0.1, 0.3), 3u);  // and 0.3 / 0.1 is 2.999...
  EXPECT_EQ(ticks(0.1, 0.31), 4u);
  EXPECT_EQ(ticks(0.2, 0.01), 1u);
  EXPECT_EQ(ticks(0.2, 0), 0u);
}

TEST_F(SimulationTest, RunForGoesOnFromWhereItIs) {
  Simulation simulation = json();
  simulation.run_for(0.5);
  EXPECT_EQ(simulation.tick(), 3u);
  EXPECT_DOUBLE_EQ(simulation.time_s(), 0.6);
  simulation.run_for(0.4);
  EXPECT_EQ(simulation.tick(), 5u);
}

TEST_F(SimulationTest, RunForRefusesWhatIsNoTime) {
  Simulation simulation = json();
  EXPECT_EQ(message_of<std::invalid_argument>([&] { simulation.run_for(-1); }),
            "run_for(-1): give a time from 0 to 1000000000000 s");
  EXPECT_THROW(simulation.run_for(std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
  EXPECT_THROW(simulation.run_for(std::numeric_limits<double>::infinity()), std::invalid_argument);
  EXPECT_EQ(simulation.tick(), 0u);
}

TEST_F(SimulationTest, PhasesComeInTheOrderOfTheTick) {
  Simulation simulation = json();
  std::vector<std::string> seen;
  simulation.on_phase([&](std::optional<Phase> phase) {
    seen.emplace_back(phase ? std::string(phase_name(*phase))
                            : "end of " + std::to_string(simulation.tick()));
  });
  simulation.run_for(0.4);
  EXPECT_THAT(seen, ElementsAre("intervene", "sense", "actuate", "decide", "move", "index", "end of 1",
                                "intervene", "sense", "actuate", "decide", "move", "index", "end of 2"));
  EXPECT_EQ(k_phases, 6u);
  simulation.on_phase(nullptr);
  simulation.step();
  EXPECT_EQ(seen.size(), 14u);
}

TEST_F(SimulationTest, StatisticsCount) {
  Simulation simulation = json();
  simulation.find("r0").set_speed(0.5, 0);
  simulation.run_for(0.8);
  const Statistics s = simulation.statistics();
  EXPECT_EQ(s.robots, 2u);
  EXPECT_EQ(s.ticks, 4u);
  EXPECT_DOUBLE_EQ(s.time_s, 0.8);
  EXPECT_EQ(s.beams, 4u * 4u);  // the front sensor's, each tick
  EXPECT_EQ(s.stalled, 0u);
  EXPECT_EQ(s.held_at_bounds, 0u);
  EXPECT_DOUBLE_EQ(s.mean_displacement_m, 0.4 / 2);
}

// ---- hashes

TEST_F(SimulationTest, AnOptionIsOneLineOfTheHashLog) {
  const std::string name = "a\nb\\nc.json";
  const Simulation simulation = Simulation::from_text(R"({"troupe": 1})", name);
  const std::string line = R"(a\nb\\nc.json)";
  EXPECT_THAT(simulation.hash_log_header(), HasSubstr("\n# world: " + line + "\n"));
  EXPECT_EQ(from_one_line(line), name);
}

TEST_F(SimulationTest, HashLogHasTheAgreedForm) {
  SimulationOptions options;
  options.threads = 2;
  Simulation simulation = json(options);
  std::istringstream header(simulation.hash_log_header());
  std::vector<std::string> keys;
  for (std::string line; std::getline(header, line);) {
    EXPECT_THAT(line, StartsWith("# "));
    keys.push_back(line.substr(2, line.find(':') - 2));
  }
  EXPECT_THAT(keys, ElementsAre("troupe hash log 1", "version", "world", "seed", "tick_s", "ranging",
                                "robots", "threads", "tile_m", "simd"));
  EXPECT_THAT(simulation.hash_log_header(), HasSubstr("# version: " + version_line() + "\n"));
  simulation.step();
  const std::regex form(
      "1 [0-9a-f]{16} pose=[0-9a-f]{16} velocity=[0-9a-f]{16} sensor=[0-9a-f]{16} memory=[0-9a-f]{16}");
  EXPECT_TRUE(std::regex_match(simulation.hash_log_line(), form)) << simulation.hash_log_line();
  const Simulation::Hashes h = simulation.hashes();
  EXPECT_EQ(simulation.hash_log_line(), "1 " + hex(h.state) + " pose=" + hex(h.pose) +
                                            " velocity=" + hex(h.velocity) + " sensor=" + hex(h.sensor) +
                                            " memory=" + hex(h.memory));
}

TEST_F(SimulationTest, TheStateHashIsTheSumOfItsGroups) {
  Simulation simulation = population();
  simulation.run_for(1);
  const Simulation::Hashes h = simulation.hashes();
  EXPECT_EQ(h.state, h.pose + h.velocity + h.sensor + h.memory);
  EXPECT_EQ(h.state, simulation.state_hash());
  EXPECT_NE(h.memory, 0u);
}

TEST_F(SimulationTest, EachGroupSeesItsPartOfTheState) {
  Simulation simulation = json();
  Simulation driven = json();
  driven.find("r0").set_speed(0.5, 0);
  EXPECT_EQ(driven.hashes().pose, simulation.hashes().pose);
  EXPECT_NE(driven.hashes().velocity, simulation.hashes().velocity);  // what was commanded is state
  simulation.step();
  driven.step();
  EXPECT_NE(driven.hashes().pose, simulation.hashes().pose);
  EXPECT_EQ(driven.hashes().sensor, simulation.hashes().sensor);  // sensed before the motion
  simulation.step();
  driven.step();
  EXPECT_NE(driven.hashes().sensor, simulation.hashes().sensor);
}

TEST_F(SimulationTest, LookingOnChangesNothing) {
  Simulation looked_at = population();
  Simulation alone = population();
  for (int i = 0; i < 10; ++i) {
    looked_at.step();
    alone.step();
    static_cast<void>(looked_at.hash_log_line());
    static_cast<void>(looked_at.statistics());
    static_cast<void>(looked_at.find("r3").ranges());
#ifdef TROUPE_HAS_RENDER
    if (i == 5) looked_at.snapshot(folder_ / "look.png", 64, 64);
#endif
  }
  EXPECT_EQ(looked_at.hash_log_line(), alone.hash_log_line());
}

// ---- several in one process

/// Hash logs of two unlike worlds, each alone.
class TwoSimulations : public test::ScratchTest {
 protected:
  static constexpr int k_ticks = test::k_slow_build ? 5 : 20;
  static Simulation crowd(unsigned threads) {
    SimulationOptions options;
    options.threads = threads;
    return Simulation(k_worlds / "crowd.json", options);
  }
  static Simulation cave(unsigned threads) {
    SimulationOptions options;
    options.threads = threads;
    options.robots = {{"", 20}};
    return Simulation(k_worlds / "cave-simple.json", options);
  }
  static std::string log(Simulation& simulation) {
    std::string lines;
    for (int i = 0; i < k_ticks; ++i) {
      simulation.step();
      lines += simulation.hash_log_line() + '\n';
    }
    return lines;
  }
};

TEST_F(TwoSimulations, SteppedInTurnAreAsAlone) {
  Simulation crowd_alone = crowd(1);
  Simulation cave_alone = cave(1);
  const std::string crowd_log = log(crowd_alone);
  const std::string cave_log = log(cave_alone);
  Simulation a = crowd(3);
  Simulation b = cave(1);
  Simulation c = cave(2);
  std::string a_log;
  std::string b_log;
  std::string c_log;
  for (int i = 0; i < k_ticks; ++i) {
    a.step();
    b.step();
    a_log += a.hash_log_line() + '\n';
    b_log += b.hash_log_line() + '\n';
    c.step();
    c_log += c.hash_log_line() + '\n';
  }
  EXPECT_EQ(a_log, crowd_log);
  EXPECT_EQ(b_log, cave_log);
  EXPECT_EQ(c_log, cave_log);
}

TEST_F(TwoSimulations, InTwoThreadsAtOnceAreAsAlone) {
  Simulation crowd_alone = crowd(1);
  Simulation cave_alone = cave(1);
  const std::string crowd_log = log(crowd_alone);
  const std::string cave_log = log(cave_alone);
  std::string a_log;
  std::string b_log;
  std::thread a([&] {
    Simulation simulation = crowd(2);
    a_log = log(simulation);
  });
  std::thread b([&] {
    Simulation simulation = cave(3);
    b_log = log(simulation);
  });
  a.join();
  b.join();
  EXPECT_EQ(a_log, crowd_log);
  EXPECT_EQ(b_log, cave_log);
}

// ---- pictures

#ifdef TROUPE_HAS_RENDER

/// What stands in a PNG's text chunks (tEXt: keyword, 0, text).
std::map<std::string, std::string> text_chunks(const std::string& png) {
  std::map<std::string, std::string> texts;
  const auto number = [&](std::size_t at) {
    std::uint32_t n = 0;
    for (std::size_t i = 0; i < 4; ++i) n = n << 8 | static_cast<unsigned char>(png[at + i]);
    return n;
  };
  for (std::size_t at = 8; at + 12 <= png.size(); at += 12 + number(at)) {
    if (png.compare(at + 4, 4, "tEXt") != 0) continue;
    const std::string body = png.substr(at + 8, number(at));
    const std::size_t zero = body.find('\0');
    texts[body.substr(0, zero)] = body.substr(zero + 1);
  }
  return texts;
}

TEST_F(SimulationTest, ASnapshotIsAPngThatSaysWhatItShows) {
  Simulation simulation = json();
  simulation.run_for(0.4);
  const fs::path png = folder_ / "room.png";
  simulation.snapshot(png, 320, 200);
  const std::string bytes = content(png);
  ASSERT_THAT(bytes, StartsWith("\x89PNG\r\n\x1a\n"));
  EXPECT_EQ(bytes.substr(16, 8), std::string("\0\0\x01\x40\0\0\0\xc8", 8));  // the header's width and height
  const auto texts = text_chunks(bytes);
  EXPECT_THAT(texts, Contains(Pair("Software", version_line())));
  EXPECT_THAT(texts, Contains(Pair("world", (folder_ / "room.json").string())));
  EXPECT_THAT(texts, Contains(Pair("time_s", "0.4")));
  EXPECT_THAT(texts, Contains(Pair("seed", "5")));
  EXPECT_THAT(texts, Contains(Pair("state_hash", hex(simulation.state_hash()))));
}

TEST_F(SimulationTest, ASnapshotThatCannotBeWrittenIsAnError) {
  const Simulation simulation = json();
  EXPECT_THAT(message_of<std::runtime_error>([&] { simulation.snapshot(folder_ / "none" / "room.png"); }),
              HasSubstr("room.png"));
}

#else

TEST_F(SimulationTest, WithoutRenderASnapshotIsAnError) {
  const Simulation simulation = json();
  EXPECT_EQ(message_of<std::runtime_error>([&] { simulation.snapshot(folder_ / "room.png"); }),
            "this build cannot draw pictures: build Troupe with the CMake option -DTROUPE_RENDER=ON");
  EXPECT_FALSE(fs::exists(folder_ / "room.png"));
}

#endif

TEST(Version, IsOneLineThatNamesCompilerFlagsAndAssertions) {
  const std::string line = version_line();
  EXPECT_THAT(line, AllOf(StartsWith("troupe "), HasSubstr("-ffp-contract=off"), Not(HasSubstr("\n"))));
  EXPECT_TRUE(std::regex_search(line, std::regex("assertions (on|off)\\)$"))) << line;
}

}  // namespace
}  // namespace troupe::simulation_test
