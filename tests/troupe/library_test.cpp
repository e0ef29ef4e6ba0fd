// Functions with which programs build, inspect and drive worlds, in addition to simulation_test.cpp.
#include "engine/kinds/controller.hpp"
#include "engine/world/world.hpp"
#include "models/devices/gripper.hpp"
#include "models/devices/led.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/registry.hpp"
#include "troupe/troupe.hpp"
#include "worldio/json/world_document.hpp"
#include "worldio/results/hdf5_file.hpp"
#include "worldio/results/recording_reader.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace troupe::library_test {
namespace {

using test::message_of;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::FloatEq;
using ::testing::HasSubstr;

// <troupe/troupe.hpp> declares what programs catch.
static_assert(std::is_base_of_v<std::runtime_error, StepError>);

/// A wall ahead at x = 2, and a row of bots that look at it.
WorldBuilder yard(int bots = 1) {
  WorldBuilder world("yard.json");
  world.wall({2, -50}, {2, 50}, 0.2);
  world.type("bot")
      .size(0.4, 0.3, 0.25)
      .color("SteelBlue")
      .drive("omni")
      .sensor("eye", "ranger",
              {{"transducers", {Settings{{"range_max_m", 5}, {"fov_deg", 60}, {"samples", 3}}}}}, {.z = 0.1})
      .sensor("skin", "bumper", {{"bumpers", {Settings{{"pose", Pose{.x = 0.2}}, {"length_m", 0.3}}}}});
  for (int i = 0; i < bots; ++i) world.add("r" + std::to_string(i), "bot", {.y = i * 1.0});
  return world;
}

// ---- worlds

/// As the program does, and before they are made: a hundred thousand would take all the memory there is.
TEST(Simulation, RefusesMoreThreadsThanALoopMayHave) {
  constexpr const char* k_text =
      "100000 threads: must be 1 to 1024, or 0 for one per processor that the process may use";
  EXPECT_EQ(message_of<std::invalid_argument>([] { Simulation(yard(), {.threads = 100'000}); }), k_text);
  WorldBuilder placed = yard();
  placed.population("s", "bot", 3, {{"rule", "grid"}, {"region_m", {{-9, -9}, {0, 0}}}, {"pitch_m", 1}});
  EXPECT_EQ(message_of<std::invalid_argument>([&] { Simulation(placed, {.threads = 100'000}); }), k_text)
      << "the loader has threads, too";
}

// So many bodies would take all the memory there is.
TEST(Simulation, RefusesMoreSpareRobotsThanTheProgram) {
  EXPECT_EQ(message_of<std::invalid_argument>([] { Simulation(yard(), {.spare = 4'000'000'000}); }),
            "SimulationOptions: spare is 4000000000: give a number from 0 to 1000000");
}

TEST(WorldBuilder, DescribesWhatAFileSays) {
  WorldBuilder world = yard(2);
  world.set("seed", 7).set("seed", 8);
  EXPECT_EQ(world.json(), R"({
  "troupe": 1,
  "seed": 8,
  "types": {
    "wall1": {
      "size_m": [100, 0.2, 0.5],
      "color": "gray40"
    },
    "bot": {
      "size_m": [0.4, 0.3, 0.25],
      "color": "SteelBlue",
      "drive": {"kind": "omni"},
      "sensors": [
        {"name": "eye", "kind": "ranger", "pose": {"z_m": 0.1}, "transducers": [{"range_max_m": 5, "fov_deg": 60, "samples": 3}]},
        {"name": "skin", "kind": "bumper", "bumpers": [{"pose": {"x_m": 0.2}, "length_m": 0.3}]}
      ]
    }
  },
  "models": [
    {"name": "wall1", "type": "wall1", "pose": {"x_m": 2, "heading_rad": 1.5707963267948966}},
    {"name": "r0", "type": "bot", "pose": {}},
    {"name": "r1", "type": "bot", "pose": {"y_m": 1}}
  ]
}
)");
  Simulation built(world);
  Simulation read = Simulation::from_text(world.json(), "yard.json");
  EXPECT_EQ(built.seed(), 8u);
  EXPECT_EQ(built.title(), read.title());
  built.run_for(1);
  read.run_for(1);
  EXPECT_EQ(built.state_hash(), read.state_hash());
}

TEST(WorldBuilder, TakesPopulationsAndOptions) {
  WorldBuilder world = yard(0);
  world.population("s", "bot", 3, {{"rule", "grid"}, {"region_m", {{-9, -9}, {0, 0}}}, {"pitch_m", 1}},
                   {{"color", "red"}});
  const Simulation simulation(world, {.threads = 1, .seed = 3, .robots = {{"s", 5}}});
  EXPECT_EQ(simulation.robots(), 5u);
  EXPECT_EQ(simulation.seed(), 3u);
}

TEST(WorldBuilder, AllThatIsWrongComesOutWithTheLinesOfItsText) {
  WorldBuilder world("bad");
  world.type("bot").size(1, 1, 1).drive("dif").sensor("eye", "ranger", {{"range_m", 2}});
  world.add("r0", "bott", {});
  EXPECT_THAT(
      message_of<InputError>([&] { const Simulation simulation(world); }),
      AllOf(HasSubstr("bad.json:6: error: /types/bot/drive/kind: unknown drive \"dif\"; known: car, diff, "
                      "omni (did you mean \"diff\"?)"),
            HasSubstr("bad.json:8: error: /types/bot/sensors/0: unknown key \"range_m\""),
            HasSubstr("\"bott\"")));
}

/// A box that drives, as plain data.
worldio::WorldDocument box_world() {
  worldio::WorldDocument world;
  world.seed = 5;
  auto& [key, bot] = world.types.emplace_back();
  key = "bot";
  bot.image.size = Eigen::Vector3d(0.4, 0.3, 0.2);
  bot.drive.emplace().kind = "diff";
  worldio::ModelDocument& model = world.models.emplace_back();
  model.name = "r0";
  model.type = "bot";
  model.pose = {.x = 1, .heading = 2};
  return world;
}

TEST(WorldDocument, SaysWhatABuilderSays) {
  WorldBuilder built;
  built.set("seed", 5);
  built.type("bot").size(0.4, 0.3, 0.2).drive("diff");
  built.add("r0", "bot", {.x = 1, .heading = 2});
  Simulation of_builder(built);
  Simulation of_document(box_world());
  EXPECT_EQ(of_document.title(), "world");
  of_builder.run_for(1);
  of_document.run_for(1);
  EXPECT_EQ(of_builder.state_hash(), of_document.state_hash());

  worldio::WorldDocument many = box_world();
  worldio::PopulationDocument& robots = many.populations.emplace_back();
  robots.name = "s";
  robots.type = "bot";
  robots.count = 3;
  robots.place.emplace().rule = engine::PlacementRule::Kind::uniform;
  robots.place->region = Box::around(Vec2(10, 10), 5);
  EXPECT_EQ(Simulation(many, "many.json", {.robots = {{"s", 7}}}).robots(), 8u);
}

TEST(WorldDocument, WhatIsWrongComesOutAllAtOnce) {
  worldio::WorldDocument world = box_world();
  world.tick = -1;
  world.types[0].second.drive->kind = "dif";
  world.models[0].type.clear();
  world.models.emplace_back().where = {0, 7};
  world.models.back().type = "bott";
  world.files = std::make_shared<SourceFiles>();
  world.files->add("mine.cpp");
  EXPECT_THAT(
      message_of<InputError>([&] { const Simulation simulation(world, "made.json"); }),
      AllOf(
          HasSubstr("made.json: error: /tick_s: must be from 0.000001 to 3600 s, found -1"),
          HasSubstr("made.json: error: /types/bot/drive/kind: unknown drive \"dif\"; known: car, diff, "
                    "omni (did you mean \"diff\"?)"),
          HasSubstr("made.json: error: /models/0: missing \"type\": the name of a type, a key of \"types\""),
          HasSubstr("mine.cpp:7: error: /models/1: missing \"name\": the model's name"),
          HasSubstr("mine.cpp:7: error: /models/1/type: unknown type \"bott\"; known: bot")));
}

TEST(WorldBuilder, AKeyThatIsSaidTwiceIsAnError) {
  WorldBuilder world("bad");
  world.type("bot").size(1, 1, 1).sensor("eye", "bumper").set("sensors", std::vector<Setting>());
  EXPECT_THAT(message_of<InputError>([&] { const Simulation simulation(world); }),
              HasSubstr("bad.json:7: error: repeated key \"sensors\": first given on line 6"));
}

TEST(WorldBuilder, RefusesWhatNoFileCanSay) {
  EXPECT_EQ(message_of<std::invalid_argument>([] { Setting(std::nan("")); }),
            "numbers in a world must be finite, found nan");
  WorldBuilder world;
  const std::string empty = world.json();
  EXPECT_EQ(message_of<std::invalid_argument>([&] {
              world.wall({1, 1}, {1, 1});
            }),
            "wall(): the end points must be finite and different, found (1, 1) m and (1, 1) m");
  EXPECT_EQ(message_of<std::invalid_argument>([&] {
              world.wall({1, 1}, {2, 1}, std::nan(""));
            }),
            "wall(): the thickness and the height must be finite, found nan m and 0.5 m");
  EXPECT_THROW(world.wall({1, 1}, {std::numeric_limits<double>::infinity(), 1}), std::invalid_argument);
  EXPECT_EQ(world.json(), empty);
  EXPECT_EQ(Setting("a \"b\"\n\\").json(), R"("a \"b\"\u000a\\")");
  EXPECT_EQ(Setting(std::numeric_limits<std::uint64_t>::max()).json(), "18446744073709551615");
  EXPECT_EQ(Setting(0.1).json(), "0.1");
  EXPECT_EQ(Setting({1, 2.5, true, "x", {3}}).json(), R"([1, 2.5, true, "x", [3]])");
}

TEST(WorldBuilder, WallsLeaveTypesOfTheProgramAlone) {
  WorldBuilder world;
  world.type("wall1").size(3, 3, 3);
  world.wall({0, 0}, {2, 0});
  EXPECT_THAT(world.json(), HasSubstr(R"("wall2")"));
  EXPECT_THAT(world.json(), HasSubstr("[3, 3, 3]"));
}

// Comparing the name of each wall with those of all others would take a minute.
TEST(WorldBuilder, AMazeMayHaveManyWalls) {
  constexpr int k_walls = 100000;
  WorldBuilder world;
  for (int i = 0; i < k_walls; ++i) world.wall({0, 0.2 * i}, {1, 0.2 * i});
  world.type("wall1").set("fiducial_return", 7);
  const std::string text = world.json();
  EXPECT_NE(text.find(R"("fiducial_return": 7)"), text.npos);
  EXPECT_NE(text.find(R"("wall100000")"), text.npos);
  EXPECT_EQ(text.find(R"("wall100001")"), text.npos);
}

// ---- callbacks, and runs until

TEST(OnTick, IsCalledInOrderBehindTheStep) {
  Simulation simulation(yard());
  std::vector<std::string> calls;
  simulation.on_tick([&](Simulation& s) { calls.push_back("a" + std::to_string(s.tick())); });
  simulation.on_tick([&](Simulation& s) { calls.push_back("b" + std::to_string(s.tick())); });
  simulation.step();
  simulation.run_for(0.1);
  EXPECT_THAT(calls, ElementsAre("a1", "b1", "a2", "b2"));
  simulation.reset();
  Simulation moved = std::move(simulation);
  moved.step();
  EXPECT_THAT(calls, ElementsAre("a1", "b1", "a2", "b2", "a1", "b1"));
  moved.on_tick(nullptr);
  moved.step();
  EXPECT_EQ(calls.size(), 6u);
}

TEST(OnTick, IsRemovedWithItsOwner) {
  Simulation simulation(yard());
  int calls = 0;
  auto first = std::make_shared<int>();
  auto second = std::make_shared<int>();
  const auto held = std::make_shared<int>();
  simulation.on_tick([&first](Simulation&) { first.reset(); }, first);  // also in its own callback
  simulation.on_tick([&, held](Simulation&) { ++calls, second.reset(); }, second);
  simulation.on_tick([&, held](Simulation&) { ++calls; }, second);
  simulation.step();
  EXPECT_EQ(calls, 1) << "the owner of the third callback has expired";
  EXPECT_EQ(held.use_count(), 3);
  simulation.step();
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(held.use_count(), 1) << "the callbacks are destroyed";
  EXPECT_THROW(simulation.on_tick(nullptr, held), std::invalid_argument);
  simulation.on_tick([&](Simulation&) { ++calls; }, held);
  simulation.on_tick([&](Simulation&) { ++calls; });
  simulation.on_tick(nullptr);
  simulation.step();
  EXPECT_EQ(calls, 2) << "on_tick(nullptr) removes only the callback without an owner";
}

TEST(OnTick, MayDriveAndPut) {
  Simulation called(yard());
  Simulation looped(yard());
  const auto drive = [](Simulation& s) {
    Model robot = s.find("r0");
    robot.set_speed(0.2, 0.1);
    if (s.tick() == 3) robot.set_pose({.x = -1, .y = 4});
  };
  called.on_tick(drive);
  called.run_for(1);
  for (int i = 0; i < 10; ++i) {
    looped.step();
    drive(looped);
  }
  EXPECT_EQ(called.state_hash(), looped.state_hash());
}

TEST(OnTick, MayNotStepAndItsExceptionsComeOutOfTheStep) {
  Simulation simulation(yard());
  simulation.on_tick([](Simulation& s) { s.step(); });
  EXPECT_EQ(message_of<std::logic_error>([&] { simulation.step(); }),
            "step() is not allowed in a callback of on_tick(): call it outside the callback");
  EXPECT_EQ(simulation.tick(), 1u);
  simulation.on_tick(nullptr);
  simulation.on_tick([](Simulation& s) { s.on_tick(nullptr); });
  EXPECT_THROW(simulation.step(), std::logic_error);
  simulation.on_tick(nullptr);
  simulation.step();
  EXPECT_EQ(simulation.tick(), 3u);
}

// A step within a step would apply the interventions twice; a callback that replaces itself would be
// destroyed while it runs.
TEST(BeforeTick, MayNotStepNorReplaceItself) {
  using Callback = std::function<void(Simulation&)>;
  const std::vector<std::pair<std::string, Callback>> forbidden = {
      {"step()", [](Simulation& s) { s.step(); }},
      {"step()", [](Simulation& s) { s.run_for(1); }},
      {"reset()", [](Simulation& s) { s.reset(); }},
      {"reset()", [](Simulation& s) { s.reset(7); }},
      {"on_tick()", [](Simulation& s) { s.on_tick([](Simulation&) {}); }},
  };
  Simulation simulation(yard());
  const auto expect_refused = [&](const std::string& what, const std::string& callback) {
    EXPECT_EQ(message_of<std::logic_error>([&] { simulation.step(); }),
              what + " is not allowed in a callback of " + callback + ": call it outside the callback");
    EXPECT_EQ(simulation.tick(), 0u);
    simulation.before_tick(nullptr);
    simulation.before_step(nullptr);
    simulation.reset();
  };
  for (const auto& [what, callback] : forbidden) {
    simulation.before_tick(callback);
    expect_refused(what, "before_tick()");
    simulation.before_step(callback);
    expect_refused(what, "before_step()");
  }
  simulation.before_tick([](Simulation& s) { s.before_tick(nullptr); });
  expect_refused("before_tick()", "before_tick()");
  simulation.before_step([](Simulation& s) { s.before_step(nullptr); });
  expect_refused("before_step()", "before_step()");
  simulation.on_tick([](Simulation& s) { s.before_tick(nullptr); });
  simulation.step();
  EXPECT_EQ(simulation.tick(), 1u);
}

/// A controller of a program that uses its simulation.
struct Meddler {
  static inline std::function<void()> acts;
  void operator()(const engine::Percept&, Random&, engine::Actions&) const {
    if (acts) acts();
  }
};

// Commands for other robots would come before or after the decisions of these robots, depending on threads.
// Hashes and measures would be those of half a tick, and their loops would use the threads of the step.
TEST(Controllers, MayNotStepCommandOrMeasureTheirSimulation) {
  engine::Registry registry = make_registry();
  registry.controllers.push_back(engine::make_controller_kind<Meddler>("meddler", "uses its simulation"));
  WorldBuilder world = yard(3);
  world.type("bot").controller("meddler").device("lamp", "led");
  for (const unsigned threads : {1u, 2u}) {
    Simulation simulation(world, {.threads = threads}, registry);
    Model other = simulation.find("r2");
    Swarm all = simulation.swarm();
    Measures measures(simulation, {"stalls"});
    const std::vector<Model::Speed> speeds(all.size());
    const std::vector<std::uint8_t> shows(all.size());
    const std::vector<std::pair<std::string, std::function<void()>>> refused{
        {"step()", [&] { simulation.step(); }},
        {"act()", [&] { simulation.act({.kind = engine::Act::Kind::hold, .whom = "r2"}); }},
        {"set_speed()", [&] { other.set_speed(0.1, 0); }},
        {"accelerate()", [&] { other.accelerate(0.1, 0); }},
        {"go_to()", [&] { other.go_to({.x = 1}); }},
        {"set_estimate()", [&] { other.set_estimate({}); }},
        {"command()", [&] { other.command<models::LedCommand>("lamp").show(1, 0, 0); }},
        {"asked()", [&] { other.asked("lamp"); }},
        {"set_speeds()", [&] { all.set_speeds(speeds); }},
        {"set_commands()", [&] { all.set_commands(std::as_bytes(std::span(shows)), "shows", "lamp"); }},
        {"for_each()", [&] { all.for_each([](std::size_t, Model&) {}); }},
        {"hashes()", [&] { static_cast<void>(simulation.state_hash()); }},
        {"making measures", [&] { Measures(simulation, {"stalls"}); }},
        {"see()", [&] { measures.see(); }},
        {"value()", [&] { static_cast<void>(measures.values()); }},
        {"set_command()", [&] {
           simulation.world().set_command(Row(0), {0.1, 0, 0});
         }}};
    simulation.step();
    const std::uint64_t state = simulation.state_hash();
    for (const auto& [what, acts] : refused) {
      simulation.reset();
      Meddler::acts = acts;
      EXPECT_THAT(message_of<StepError>([&] { simulation.step(); }),
                  AllOf(HasSubstr("tick 1: controller \"meddler\" of \"r"),
                        HasSubstr("threw: " + what + " is not allowed during a step")));
      Meddler::acts = nullptr;
      simulation.reset();
      simulation.step();
      EXPECT_EQ(simulation.state_hash(), state) << what;
    }
  }
}

TEST(RunUntil, EndsWithThePredicateOrTheTime) {
  Simulation simulation(yard());
  Model robot = simulation.find("r0");
  robot.set_speed(0.5, 0);
  EXPECT_TRUE(simulation.run_until([&](const Simulation&) { return robot.ranges()[1] < 1; }, 60));
  EXPECT_LT(robot.ranges()[1], 1);
  EXPECT_GT(robot.ranges()[1], 0.9);
  const std::uint64_t tick = simulation.tick();
  EXPECT_TRUE(simulation.run_until([](const Simulation&) { return true; }, 1));
  EXPECT_EQ(simulation.tick(), tick + 1);
  EXPECT_FALSE(simulation.run_until([](const Simulation&) { return true; }, 0));
  EXPECT_FALSE(simulation.run_until([](const Simulation&) { return false; }, 0.5));
  EXPECT_EQ(simulation.tick(), tick + 6);
  EXPECT_THROW(simulation.run_until([](const Simulation&) { return false; }, -1), std::invalid_argument);
  EXPECT_EQ(message_of<std::invalid_argument>([&] { simulation.run_until(nullptr, 1); }),
            "run_until(): found a null function: give a function that returns whether to stop");
  EXPECT_EQ(simulation.tick(), tick + 6);
}

// ---- many robots at once

/// Where everybody is after driving by what they see and by chance.
std::uint64_t driven_hash(unsigned threads) {
  Simulation simulation(yard(200), {.threads = threads});
  Swarm swarm = simulation.swarm();
  std::vector<double> seen(swarm.size());
  simulation.on_tick([&](Simulation& s) {
    swarm.for_each([&](std::size_t i, Model& robot) {
      seen[i] = s.cast(robot.pose(), 3, &robot).range_m + robot.ranges()[0];
      Random random = robot.random("drive");
      robot.set_speed(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), seen[i] - 4);
    });
  });
  simulation.run_for(3);
  return simulation.state_hash();
}

TEST(ForEach, IsTheSameOnAnyNumberOfThreads) {
  const std::uint64_t one = driven_hash(1);
  EXPECT_EQ(driven_hash(2), one);
  EXPECT_EQ(driven_hash(5), one);
  EXPECT_NE(Simulation(yard(200)).state_hash(), one);
}

TEST(ForEach, CallsForEachOnceWithItsIndex) {
  Simulation simulation(yard(100));
  Swarm swarm = simulation.swarm();
  std::vector<std::string> names(swarm.size());
  swarm.for_each([&](std::size_t i, Model& robot) { names[i] += robot.name(); });
  EXPECT_EQ(names, swarm.names());
}

TEST(ForEach, RefusesANullFunction) {
  Simulation simulation(yard(2));
  for (Swarm swarm : {simulation.swarm(), simulation.swarm("r0")})
    EXPECT_EQ(message_of<std::invalid_argument>([&] { swarm.for_each(nullptr); }),
              "for_each(): found a null function: give a function to call for each robot");
}

TEST(ForEach, MayFindModelsByTheirNames) {
  Simulation simulation(yard(100), {.threads = 4});
  Swarm swarm = simulation.swarm();
  std::vector<std::string> found(swarm.size());
  swarm.for_each([&](std::size_t i, Model& robot) { found[i] = simulation.find(robot.name()).name(); });
  EXPECT_EQ(found, swarm.names());
}

TEST(ForEach, GivesTheExceptionOfTheFirstRobot) {
  Simulation simulation(yard(100), {.threads = 4});
  Swarm swarm = simulation.swarm();
  std::vector<int> called(swarm.size());
  EXPECT_EQ(message_of<std::runtime_error>([&] {
              swarm.for_each([&](std::size_t i, Model& robot) {
                called[i] = 1;
                if (i % 10 == 7) throw std::runtime_error(robot.name());
              });
            }),
            "r7");
  EXPECT_THAT(called, ::testing::Each(1));
}

/// Returns the error of act(robot) in for_each(): act() uses other robots or the whole simulation.
template <class Do>
std::string refused_in_for_each(Simulation& simulation, Do&& act) {
  Swarm swarm = simulation.swarm("bot");
  return message_of<std::logic_error>(
      [&] { swarm.for_each([&](std::size_t, Model& robot) { act(robot); }); });
}

TEST(ForEach, RefusesWhatChangesMoreThanItsRobot) {
  WorldBuilder world = yard(3);
  world.population("s", "bot", 1, {{"rule", "grid"}, {"region_m", {{-9, -9}, {-5, -5}}}, {"pitch_m", 1}},
                   {{"reserve", 2}});
  Simulation simulation(world, {.threads = 2});
  Swarm all = simulation.swarm();
  const std::vector<Model::Speed> speeds(all.size());
  const std::vector<Pose> poses(all.size());
  Model other = simulation.find("r2");
  const std::uint64_t before = simulation.state_hash();
  using Do = std::function<void(Model&)>;
  const std::vector<std::pair<std::string, Do>> acts{
      {"set_pose()", [](Model& robot) { robot.set_pose({.x = -3}); }},
      {"set_poses()",
       [&](Model& robot) { simulation.set_poses(std::vector{std::pair(robot, Pose{.x = -3})}); }},
      {"a command for a swarm", [&](Model&) { all.set_poses(poses); }},
      {"a command for a swarm", [&](Model&) { all.set_speeds(speeds); }},
      {"spawn()", [&](Model&) { simulation.spawn("s", {.x = -3}); }},
      {"remove()", [&](Model& robot) { simulation.remove(robot); }},
      {"step()", [&](Model&) { simulation.step(); }},
      {"reset()", [&](Model&) { simulation.reset(); }},
      {"on_tick()", [&](Model&) { simulation.on_tick(nullptr); }},
      {"on_phase()", [&](Model&) { simulation.on_phase(nullptr); }},
      {"on_task()", [&](Model&) { simulation.on_task(nullptr); }},
      {"on_loop()", [&](Model&) { simulation.on_loop(nullptr); }},
      {"on_save()", [&](Model&) { simulation.on_save("mine", nullptr); }},
      {"save()", [&](Model&) { simulation.save("run.h5"); }},
      {"record()", [&](Model&) { simulation.record("run.h5"); }},
      {"stop_recording()", [&](Model&) { simulation.stop_recording(); }},
      {"for_each()", [&](Model&) { all.for_each([](std::size_t, Model& robot) { robot.set_speed(1, 0); }); }},
      {"subscribe()", [&](Model&) { all.subscribe(); }}};
  for (const auto& act : acts)
    EXPECT_EQ(refused_in_for_each(simulation, act.second),
              act.first +
                  " is not allowed in for_each(), here for \"r0\": for_each() calls the function for several "
                  "robots at once, and each call may change only the commands of its own robot; collect "
                  "other changes and apply them after for_each()");
  EXPECT_EQ(simulation.state_hash(), before);
  EXPECT_THAT(refused_in_for_each(simulation, [&](Model&) { other.set_speed(1, 0); }),
              HasSubstr("a command for \"r2\" is not allowed in for_each(), here for \"r0\""));
  EXPECT_THAT(refused_in_for_each(simulation, [&](Model&) { static_cast<void>(simulation.state_hash()); }),
              HasSubstr("a parallel loop must not begin in a task of another loop of the same world"));
  other.set_pose({.x = -3, .y = 7});  // it is over
}

TEST(ForEach, LeavesOtherSimulationsToItsCalls) {
  Simulation simulation(yard(3), {.threads = 1});
  Simulation other(yard(1), {.threads = 1});
  Model stranger = other.find("r0");
  simulation.swarm().for_each([&](std::size_t i, Model& robot) {
    robot.set_speed(0.1, 0);
    stranger.set_pose({.x = -1.0 * static_cast<double>(i)});
    other.step();
  });
  EXPECT_EQ(other.tick(), 3u);
}

// ---- rays

TEST(Cast, MeetsTheNearestAndSaysWhoseItIs) {
  Simulation simulation(yard(2));
  const Model robot = simulation.find("r0");
  const RayHit wall = simulation.cast({.x = 0.5, .z = 0.1}, 5);
  EXPECT_DOUBLE_EQ(wall.range_m, 1.4);
  EXPECT_EQ(simulation.model(wall.body).name(), "wall1");
  EXPECT_EQ(wall.body, simulation.find("wall1").id());
  // From within r0 to the inner side of its own body, and, without it, to r1, whose side is at y = 0.85.
  const Pose left{.z = 0.1, .heading = std::numbers::pi / 2};
  EXPECT_EQ(simulation.cast(left, 5).body, robot.id());
  const RayHit other = simulation.cast(left, 5, &robot);
  EXPECT_EQ(other.body, simulation.find("r1").id());
  EXPECT_NEAR(other.range_m, 0.85, 1e-12);
}

TEST(Cast, MeetsNothingBelowItsRangeOrAboveTheBodies) {
  Simulation simulation(yard());
  for (const RayHit& hit :
       {simulation.cast({.x = 0.5, .z = 0.1}, 1.3), simulation.cast({.x = 0.5, .z = 3}, 5)})
    EXPECT_FALSE(hit.met());
  EXPECT_EQ(simulation.cast({.x = 0.5, .z = 3}, 5).range_m, 5);
}

TEST(Cast, IsWhatTheRangerReads) {
  Simulation simulation(yard(3));
  simulation.step();
  const Model robot = simulation.find("r1");
  const std::span<const float> ranges = robot.ranges();
  for (std::size_t k = 0; k < 3; ++k) {
    const Pose beam{.y = 1, .z = 0.1, .heading = (static_cast<double>(k) - 1) * std::numbers::pi / 6};
    EXPECT_NEAR(simulation.cast(beam, 5, &robot).range_m, ranges[k], 1e-6);
  }
}

TEST(Cast, RefusesWhatIsNoRay) {
  Simulation simulation(yard());
  Simulation other(yard());
  const Model stranger = other.find("r0");
  EXPECT_THROW(simulation.cast({.x = std::nan("")}, 1), std::invalid_argument);
  EXPECT_THROW(simulation.cast({}, std::numeric_limits<double>::infinity()), std::invalid_argument);
  EXPECT_THROW(simulation.cast({}, -1), std::invalid_argument);
  EXPECT_THROW(simulation.cast({}, 1, &stranger), std::logic_error);
  EXPECT_EQ(message_of<std::out_of_range>([&] { simulation.model(BodyId(99)); }),
            "no model with id 99: the world has 3 bodies, whose ids begin at 0");
}

// ---- every sensor

/// A robot with one of each kind, before something for each to see.
WorldBuilder show() {
  WorldBuilder world;
  world.wall({2, -3}, {2, 3}, 0.2);
  world.type("zone").size(2, 2, 0.001).color({0, 1, 0}).set("obstacle", false).set("ranger_return", -1);
  world.type("beacon")
      .size(0.2, 0.2, 0.5)
      .color("red")
      .set("fiducial_return", 42)
      .device("bulb", "blinkenlight", {{"dutycycle", 1}});
  world.type("bot")
      .size(0.2, 0.2, 0.25)
      .drive("diff")
      .sensor("eye", "fiducial", {{"range_max_m", 5}})
      .sensor("blobs", "blobfinder", {{"colors", {"red"}}})
      .sensor("skin", "bumper", {{"bumpers", {Settings{{"pose", Pose{.x = 0.1}}, {"length_m", 0.2}}}}})
      .sensor("cam", "camera", {{"width", 8}, {"height", 4}})
      .sensor("floor", "ground")
      .sensor("sun", "light_sensor", {{"directions", 4}, {"range_max_m", 5}})
      .sensor("talk", "radio", {{"range_m", 3}, {"beacon", true}})
      .device("lamp", "led", {{"shows", {0, 0, 1}}});
  world.add("zone", "zone", {});
  world.add("beacon", "beacon", {.x = 1});
  world.add("r0", "bot", {});
  world.add("r1", "bot", {.x = -1});
  return world;
}

TEST(Readings, TellEverySensor) {
  Simulation simulation(show());
  simulation.run_for(0.3);
  const Model robot = simulation.find("r0");
  EXPECT_EQ(robot.readings<std::uint32_t>("count", "eye")[0], 1u);
  EXPECT_EQ(robot.readings<std::int32_t>("id", "eye")[0], 42);
  EXPECT_THAT(robot.readings<float>("bearing", "eye")[0], FloatEq(0));
  EXPECT_EQ(robot.readings<std::uint32_t>("count", "blobs")[0], 1u);
  EXPECT_EQ(robot.readings<std::uint8_t>("hit", "skin")[0], 0);
  EXPECT_EQ(robot.readings<float>("depth").size(), 32u);
  EXPECT_EQ(robot.readings<std::uint8_t>("color", "cam").size(), 4 * 32u);
  EXPECT_THAT(robot.readings<float>("color", "floor"), ElementsAre(0, 1, 0));
  EXPECT_GT(robot.readings<float>("brightness")[0], 0.5);
  EXPECT_EQ(robot.readings<std::uint32_t>("sender", "talk")[0], simulation.find("r1").id().value);
  EXPECT_THAT(robot.readings<float>("shown_color", "lamp"), ElementsAre(0, 0, 1));
  EXPECT_EQ(robot.fields("eye")[0].name, "count");
}

TEST(Readings, SayWhatThereIsInstead) {
  Simulation simulation(show());
  const Model robot = simulation.find("r0");
  EXPECT_THAT(
      message_of<std::out_of_range>([&] { robot.readings<float>("dept"); }),
      AllOf(HasSubstr("devices of \"r0\": unknown field \"dept\""), HasSubstr("did you mean \"depth\"")));
  EXPECT_THAT(message_of<std::out_of_range>([&] { robot.readings<float>("depth", "eye"); }),
              HasSubstr("device \"eye\" of \"r0\": unknown field \"depth\"; known: bearing, body"));
  EXPECT_THAT(
      message_of<std::out_of_range>([&] { robot.readings<float>("depth", "came"); }),
      HasSubstr("\"r0\" has no device \"came\"; it has: eye, blobs, skin, cam, floor, sun, talk, lamp"));
  EXPECT_EQ(message_of<std::invalid_argument>([&] { robot.readings<double>("depth"); }),
            "field \"depth\" of device \"cam\" of \"r0\" has the type float32, not float64");
}

TEST(Readings, OfADeviceWithAnEmptyNameSayWhatThereIs) {
  Simulation simulation(show());
  Model robot = simulation.find("r0");
  EXPECT_EQ(message_of<std::out_of_range>([&] { robot.fields(""); }),
            "\"r0\" has no device \"\"; it has: eye, blobs, skin, cam, floor, sun, talk, lamp");
  EXPECT_EQ(message_of<std::out_of_range>([&] { robot.asked(""); }),
            "\"r0\" has no device that takes commands \"\"; it has: talk, lamp");
  EXPECT_EQ(message_of<std::out_of_range>([&] { robot.command_fields(""); }),
            "\"r0\" has no device that takes commands \"\"; it has: talk, lamp");
  EXPECT_EQ(message_of<std::out_of_range>([&] { robot.command<models::GripperCommand>(); }),
            "\"r0\" has no device that takes this command struct; devices that take commands: talk, lamp");
}

TEST(Commands, ReachADevice) {
  Simulation simulation(show());
  Model robot = simulation.find("r0");
  robot.command<models::LedCommand>("lamp").show(1, 0, 0.5f);
  simulation.run_for(0.2);
  EXPECT_THAT(robot.readings<float>("shown_color"), ElementsAre(1, 0, 0.5f));
  EXPECT_THAT(message_of<std::invalid_argument>([&] { robot.command<models::GripperCommand>("lamp"); }),
              HasSubstr("\"lamp\" of \"r0\" takes commands of kind led, with the fields shows (uint8), red "
                        "(float32), green (float32), blue (float32) in 16 bytes; the given struct has the "
                        "fields order (uint8) in 1 bytes"));
  struct Another {  // as large as an LED's, and no LED's
    std::uint8_t mode = 0;
    std::array<float, 3> goal{};
    TROUPE_FIELDS(mode, goal)
  };
  EXPECT_THAT(message_of<std::invalid_argument>([&] { robot.command<Another>("lamp"); }),
              HasSubstr("the given struct has the fields mode (uint8), goal (float32 x 3) in 16 bytes"));
  EXPECT_THROW(robot.command<Another>(), std::out_of_range);
  struct Percent {  // the names of an LED's fields, but other types
    std::uint8_t shows = 0;
    std::int32_t red = 0, green = 0, blue = 0;
    TROUPE_FIELDS(shows, red, green, blue)
  };
  EXPECT_THAT(message_of<std::invalid_argument>([&] { robot.command<Percent>("lamp"); }),
              HasSubstr("the given struct has the fields shows (uint8), red (int32), green (int32), blue "
                        "(int32) in 16 bytes"));
  EXPECT_EQ(&robot.command<models::LedCommand>(), &robot.command<models::LedCommand>("lamp"));
  const Model::Asked asked = robot.asked("lamp");
  EXPECT_EQ(asked.bytes.size(), sizeof(models::LedCommand));
  EXPECT_EQ(asked.fields[1].name, "red");
  EXPECT_THROW(robot.asked("cam"), std::out_of_range);
  EXPECT_THAT(message_of<std::out_of_range>([&] { robot.command<models::LedCommand>("cam"); }),
              HasSubstr("\"r0\" has no device that takes this command struct \"cam\"; it has: "));
}

// ---- recordings and pictures

class LibraryFilesTest : public test::ScratchTest {};

// A callback of on_phase() is called within a step: a step or a change there would use half of a new state.
TEST_F(LibraryFilesTest, CallbacksOfPhasesMayNotChangeTheSimulation) {
  WorldBuilder world = yard(2);
  world.population("s", "bot", 1, {{"rule", "grid"}, {"region_m", {{-9, -9}, {-5, -5}}}, {"pitch_m", 1}},
                   {{"reserve", 2}});
  using Callback = std::function<void(Simulation&)>;
  const std::vector<std::pair<std::string, Callback>> forbidden = {
      {"step()", [](Simulation& s) { s.step(); }},
      {"reset()", [](Simulation& s) { s.reset(); }},
      {"reset()", [](Simulation& s) { s.reset(7); }},
      {"set_pose()", [](Simulation& s) { s.find("r0").set_pose({.x = -3}); }},
      {"spawn()", [](Simulation& s) { s.spawn("s", {.x = -3}); }},
      {"remove()", [](Simulation& s) { s.remove(s.find("r0")); }},
      {"disable()", [](Simulation& s) { s.disable(s.find("r0")); }},
      {"enable()", [](Simulation& s) { s.enable(s.find("r0")); }},
      {"set()", [](Simulation& s) { s.set("bot", R"({"drive": {"velocity_max_x_mps": 1}})"); }},
      {"save()", [&](Simulation& s) { s.save(folder_ / "run.h5"); }},
      {"record()", [&](Simulation& s) { s.record(folder_ / "run.h5"); }},
      {"on_tick()", [](Simulation& s) { s.on_tick([](Simulation&) {}); }},
      {"before_tick()", [](Simulation& s) { s.before_tick(nullptr); }},
      {"before_step()", [](Simulation& s) { s.before_step(nullptr); }},
      {"act()", [](Simulation& s) { s.act({}); }},
      {"subscribe()", [](Simulation& s) { s.subscribe("r0"); }},
      {"for_each()", [](Simulation& s) { s.swarm("bot").for_each([](std::size_t, Model&) {}); }},
      {"set_speeds()", [](Simulation& s) { s.swarm("bot").set_speeds(std::vector<Model::Speed>(3)); }},
      {"set_speed()", [](Simulation& s) { s.find("r0").set_speed(1, 0); }},
      {"set_estimate()", [](Simulation& s) { s.find("r0").set_estimate({}); }},
      {"on_phase()", [](Simulation& s) { s.on_phase(nullptr); }},
      {"on_task()", [](Simulation& s) { s.on_task(nullptr); }},
      {"on_loop()", [](Simulation& s) { s.on_loop(nullptr); }},
      {"hashes()", [](Simulation& s) { static_cast<void>(s.hash_log_line()); }},
  };
  Simulation simulation(world, {.mortal = true});
  simulation.step();
  const std::uint64_t state = simulation.state_hash();
  for (const auto& [what, callback] : forbidden)
    for (const auto when : std::vector<std::optional<Phase>>{Phase::intervene, Phase::move, std::nullopt}) {
      simulation.on_phase([&, &act = callback](std::optional<Phase> phase) {
        if (phase == when) act(simulation);
      });
      EXPECT_EQ(message_of<std::logic_error>([&] { simulation.step(); }),
                what +
                    " is not allowed during a step, for example in a callback of on_phase() or in a "
                    "controller: call it between two steps");
      simulation.on_phase(nullptr);
      simulation.reset();
      simulation.step();
      EXPECT_EQ(simulation.state_hash(), state) << what;
    }
}

TEST_F(LibraryFilesTest, ARunIsRecordedUntilItIsSaidToStop) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
  Simulation simulation(yard());
  simulation.run_for(0.2);
  simulation.record(folder_ / "run.h5", {.fields = {"pose", "ranges"}, .every_s = 0.2});
  EXPECT_THAT(message_of<std::logic_error>([&] { simulation.record(folder_ / "other.h5"); }),
              HasSubstr("other.h5: this run is already being recorded; call stop_recording() first"));
  simulation.on_tick(
      [](Simulation& s) { s.find("r0").set_pose({.x = -0.1 * static_cast<double>(s.tick())}); });
  simulation.run_for(0.4);
  simulation.stop_recording();
  simulation.stop_recording();
  simulation.run_for(0.4);
  const worldio::RecordingReader recording(folder_ / "run.h5");
  EXPECT_THAT(recording.ticks(), ElementsAre(2, 4, 6));
  EXPECT_THROW(simulation.record(folder_ / "run.h5"), InputError);

  simulation.record(folder_ / "next.h5");
  simulation.reset();  // a recording is of one run
  simulation.run_for(0.2);
  EXPECT_THAT(worldio::RecordingReader(folder_ / "next.h5").ticks(), ElementsAre(10));
}

TEST_F(LibraryFilesTest, RecordingChangesNothing) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
  Simulation plain(yard());
  Simulation recorded(yard());
  recorded.record(folder_ / "run.h5");
  plain.run_for(1);
  recorded.run_for(1);
  EXPECT_EQ(plain.state_hash(), recorded.state_hash());
}

#ifdef TROUPE_HAS_RENDER
TEST_F(LibraryFilesTest, ASnapshotTakesTheOptionsOfPictures) {
  const Simulation simulation(yard());
  simulation.snapshot(folder_ / "side.png",
                      {.width = 80, .height = 60, .camera = "follow:r0", .across_m = 4});
  EXPECT_GT(std::filesystem::file_size(folder_ / "side.png"), 100u);
  EXPECT_THROW(simulation.snapshot(folder_ / "no.png", {.camera = "follow:missing"}), InputError);
}
#endif

}  // namespace
}  // namespace troupe::library_test
