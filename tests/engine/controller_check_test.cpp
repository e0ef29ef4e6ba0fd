#include "engine/observing/controller_check.hpp"

#include "engine/observing/displacement.hpp"
#include "models/drives/wheels.hpp"
#include "tests/support/devices.hpp"
#include "tests/support/rogue_controllers.hpp"
#include "tests/support/scene.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace troupe::engine::controller_check_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using Repeat = ControllerFinding::Repeat;

const Registry& registry() {
  static const Registry kinds = [] {
    Registry all = test::registry();
    for (ControllerKind& kind : test::rogue_controllers()) all.controllers.push_back(std::move(kind));
    return all;
  }();
  return kinds;
}

constexpr std::size_t k_robots = 300;  // more than a batch of either time

/// Robots on a grid, far apart, each with these controllers.
struct Swarm {
  Diagnostics diagnostics;
  World world;
  explicit Swarm(const std::vector<std::string>& controllers, unsigned threads = 2)
      : world(make(controllers), registry(), {.threads = threads}, diagnostics) {}

  static WorldSpec make(const std::vector<std::string>& controllers) {
    test::SceneBuilder scene;
    const TypeId type = scene.robot("bot", {Solid{{test::box_ring(0.2, 0.2)}, {0, 0.3}}}, "omni");
    for (const std::string& kind : controllers)
      scene[type].controllers.push_back(
          {.kind = kind, .params = registry().controller(kind)->params.defaults()});
    for (std::size_t i = 0; i < k_robots; ++i)
      scene.body(fmt::format("r{}", i), type,
                 {3.0 * static_cast<double>(i % 20), 3.0 * static_cast<double>(i / 20), 0, 0});
    return scene.spec;
  }
};

std::vector<ControllerFinding> on_another_thread(ControllerCheck& check) {
  std::vector<ControllerFinding> findings;
  std::thread([&] { findings = check.repeat(); }).join();
  return findings;
}

std::vector<ControllerFinding> findings_of(const std::string& controller, unsigned threads = 2) {
  Swarm swarm({controller}, threads);
  ControllerCheck check(swarm.world, registry());
  swarm.world.step();
  return on_another_thread(check);
}

auto is_finding(const std::string& controller, const std::string& field, Repeat repeat) {
  return AllOf(Field(&ControllerFinding::controller, controller), Field(&ControllerFinding::field, field),
               Field(&ControllerFinding::repeat, repeat));
}

TEST(ControllerCheck, FindsNothingInAFunction) {
  Swarm swarm({"honest"});
  ControllerCheck check(swarm.world, registry());
  EXPECT_THAT(check.start_twice(), IsEmpty());
  for (int tick = 1; tick <= 5; ++tick) {
    swarm.world.step();
    EXPECT_EQ(check.pending(), k_robots);
    EXPECT_THAT(on_another_thread(check), IsEmpty()) << tick;
    EXPECT_EQ(check.pending(), 0u);
  }
  EXPECT_EQ(check.decisions(), 5 * k_robots);
}

TEST(ControllerCheck, RepeatsWithWhatRobotsBelievedThen) {
  for (const char* localization : {"gps", "odom"}) {
    WorldSpec spec = Swarm::make({"believer"});
    spec.types.back().drive = test::drive("omni", {{"localization", localization}});
    Diagnostics diagnostics;
    World world(std::move(spec), registry(), {.threads = 2}, diagnostics);
    ControllerCheck check(world, registry());
    for (int tick = 1; tick <= 7; ++tick) {
      world.step();
      ASSERT_THAT(on_another_thread(check), IsEmpty()) << localization << ", tick " << tick;
    }
  }
}

/// A death leaves nothing of what the robot decided by: in the same tick, after the decision.
TEST(ControllerCheck, RepeatsTheDecisionsOfRobotsThatDieInTheTick) {
  test::SceneBuilder scene;
  const TypeId bot = scene.robot("bot", {Solid{{test::box_ring(0.2, 0.2)}, {0, 0.3}}});
  scene[bot].devices.push_back(test::ranger("eye", {{.range_max = 3, .fov = 2.0, .samples = 31}}));
  scene[bot].controllers.push_back(test::controller("wander"));
  for (int i = 0; i < 20; ++i)
    scene.body(fmt::format("r{}", i), bot, {1.0 * (i % 5), 1.0 * (i / 5), 0, 0.3 * i});
  const TypeId trap = scene.type("trap", {}, {.obstacle = false, .ranger = -1});
  scene[trap].devices.push_back(
      {.name = "trap",
       .kind = "remover",
       .params = test::record(test::registry().device("remover")->params, {{"radius", 1.2}})});
  scene.body("trap", trap, {2, 1.5, 0, 0});
  World world = scene.world();
  ControllerCheck check(world, test::registry());
  for (int tick = 1; tick <= 20; ++tick) {
    world.step();
    const std::vector<ControllerFinding> findings = on_another_thread(check);
    ASSERT_THAT(findings, IsEmpty()) << "tick " << tick << ": " << finding_text(world, findings.front());
    if (tick == 1) {
      ASSERT_EQ(world.view().absent_count(), 6u);
      ASSERT_EQ(check.decisions(), 20u) << "those that died decided before";
    }
  }
}

/// Of a controller that was made afresh with the file's parameters all would be said to decide otherwise.
TEST(ControllerCheck, MakesControllersAfreshOfTheParametersInForce) {
  test::SceneBuilder scene;
  const TypeId bot = scene.robot("bot", {Solid{{test::box_ring(0.2, 0.2)}, {0, 0.3}}});
  scene[bot].devices.push_back(test::ranger("eye", {{.range_max = 3, .fov = 2.0, .samples = 31}}));
  scene[bot].controllers.push_back(test::controller("wander"));
  for (int i = 0; i < 10; ++i) scene.body(fmt::format("r{}", i), bot, {2.0 * i, 0, 0, 0.3 * i});
  const FieldTable& table = test::registry().controller("wander")->params;
  const auto set = [&](double time_s, double speed) {
    InterventionSpec intervention{.time_s = time_s, .action = InterventionSpec::Action::set};
    Record params(table.fields.size());
    get(table, params, "cruise_speed") = speed;
    intervention.setting = SettingSpec{bot, SettingSpec::Of::controller, 0, params};
    scene.spec.experiment.at.push_back(intervention);
  };
  set(0.5, 0.1);  // in any order of time
  set(0.2, 0.7);
  World world = scene.world();
  ControllerCheck check(world, test::registry());
  const auto run = [&](int ticks) {
    for (int tick = 1; tick <= ticks; ++tick) {
      world.step();
      const std::vector<ControllerFinding> findings = on_another_thread(check);
      ASSERT_THAT(findings, IsEmpty()) << "tick " << tick << ": " << finding_text(world, findings.front());
      const double asked = tick > 5 ? 0.1 : tick > 2 ? 0.7 : 0.4;
      ASSERT_EQ(world.view().commands()[0].x, asked) << tick;
    }
  };
  run(8);
  world.reset();
  run(4);
}

/// Steps a world eight times, and expects that the check finds nothing.
void expect_no_finding_in_eight_ticks(World& world) {
  ControllerCheck check(world, test::registry());
  for (int tick = 1; tick <= 8; ++tick) {
    world.step();
    const std::vector<ControllerFinding> findings = on_another_thread(check);
    ASSERT_THAT(findings, IsEmpty()) << "tick " << tick << ": " << finding_text(world, findings.front());
  }
}

/// Controllers that read the drive when they are made must be made afresh when it changes.
TEST(ControllerCheck, MakesControllersAfreshOfTheDriveInForce) {
  test::SceneBuilder scene;
  const TypeId bot = scene.robot("bot", {test::box(0.2, 0.2)}, "omni");
  const Record far_and_soon{50.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0};  // x, y, z, heading, time, speed, wait
  scene[bot].controllers = {test::controller("waypoints", {{"goals", std::vector<Record>{far_and_soon}}})};
  scene.body("r", bot);
  const FieldTable& drive = test::registry().drive(scene[bot].drive->kind)->params;
  InterventionSpec intervention{.time_s = 0.3, .action = InterventionSpec::Action::set};
  Record params(drive.fields.size());
  get(drive, params, "velocity_max_x") = 0.2;
  intervention.setting = SettingSpec{bot, SettingSpec::Of::drive, 0, params};
  scene.spec.experiment.at.push_back(intervention);
  World world = scene.world();
  ASSERT_NO_FATAL_FAILURE(expect_no_finding_in_eight_ticks(world));
  EXPECT_EQ(world.view().commands()[0].x, 0.2);
}

TEST(ControllerCheck, MakesControllersAfreshOfTheWheelsInForce) {
  test::SceneBuilder scene;
  const TypeId base = scene.type("base", {test::box(0.2, 0.2)});
  scene[base].parts.push_back({.name = "cart", .solids = {test::box(0.1, 0.1)}});
  const std::size_t wheels = test::add_device(scene[base], "cart", "wheels", {}, {{"drive", "omni"}});
  scene[base].devices[wheels].part = 1;
  scene[base].parts[1].joint = scene[base].devices[wheels].moves;
  const Record far_and_soon{50.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0};  // x, y, z, heading, time, speed, wait
  scene[base].controllers = {test::controller("waypoints", {{"goals", std::vector<Record>{far_and_soon}}})};
  scene[base].controllers[0].part = 1;
  const BodyId body = scene.body("b", base);
  const FieldTable& table = test::registry().device("wheels")->params;
  InterventionSpec intervention{.time_s = 0.3, .action = InterventionSpec::Action::set};
  Record params(table.fields.size());
  get(table, params, "velocity_max_x") = 0.2;
  intervention.setting =
      SettingSpec{base, SettingSpec::Of::device, static_cast<std::uint32_t>(wheels), params};
  scene.spec.experiment.at.push_back(intervention);
  World world = scene.world();
  ASSERT_NO_FATAL_FAILURE(expect_no_finding_in_eight_ticks(world));
  EXPECT_EQ(test::state_of<models::WheelsState>(world, body, wheels).forward, 0.2);
}

TEST(ControllerCheck, ChangesNoResult) {
  Swarm alone({"honest"});
  Swarm watched({"honest"});
  {
    ControllerCheck check(watched.world, registry());
    for (int tick = 0; tick < 3; ++tick) {
      alone.world.step();
      watched.world.step();
      check.repeat();
    }
  }
  alone.world.step();
  watched.world.step();  // after it has gone
  EXPECT_EQ(alone.world.hashes().state, watched.world.hashes().state);
}

TEST(ControllerCheck, NamesRobotControllerFieldAndValues) {
  Swarm swarm({"honest", "keeps_a_static"}, 1);
  ControllerCheck check(swarm.world, registry());
  swarm.world.step();
  const std::vector<ControllerFinding> findings = on_another_thread(check);
  ASSERT_THAT(findings, ElementsAre(is_finding("keeps_a_static/1", "memory calls", Repeat::again)));
  EXPECT_EQ(findings[0].body, BodyId(1)) << "the lowest; the ground is 0";
  EXPECT_EQ(findings[0].decisions, k_robots);
  EXPECT_GT(findings[0].second.bits, findings[0].first.bits);
  EXPECT_THAT(
      finding_text(swarm.world, findings[0]),
      MatchesRegex("controller \"keeps_a_static/1\": memory calls of \"r0\" .id 1. is 0x[0-9a-f]+ .[0-9]+. "
                   "when the decision is repeated, not 0x[0-9a-f]+ .[0-9]+.; 300 decisions differ"));
}

TEST(ControllerCheck, CatchesRand) {
  EXPECT_THAT(findings_of("calls_rand"),
              ElementsAre(is_finding("calls_rand/0", "command turn", Repeat::again)));
}

TEST(ControllerCheck, CatchesAStatic) {
  EXPECT_THAT(findings_of("keeps_a_static"),
              ElementsAre(is_finding("keeps_a_static/0", "memory calls", Repeat::again)));
}

TEST(ControllerCheck, CatchesAThreadLocal) {
  // The rows come backwards and the thread is new: with one worker the counts go 1..n and n..1.
  EXPECT_THAT(findings_of("keeps_a_thread_local", 1),
              ElementsAre(is_finding("keeps_a_thread_local/0", "memory calls", Repeat::again)));
}

TEST(ControllerCheck, CatchesAMemberThatChanges) {
  EXPECT_THAT(findings_of("changes_a_member", 1),
              ElementsAre(is_finding("changes_a_member/0", "command x", Repeat::again)));
}

TEST(ControllerCheck, CatchesAClock) {
  EXPECT_THAT(findings_of("reads_a_fast_clock"),
              ElementsAre(is_finding("reads_a_fast_clock/0", "memory now", Repeat::again)));
}

TEST(ControllerCheck, CatchesAControllerThatIsMadeUnlike) {
  EXPECT_THAT(findings_of("is_made_unlike"),
              ElementsAre(is_finding("is_made_unlike/0", "command y", Repeat::afresh)));
}

TEST(ControllerCheck, CatchesAnAddress) {
  EXPECT_THAT(findings_of("looks_at_an_address"),
              ElementsAre(is_finding("looks_at_an_address/0", "memory place", Repeat::again)));
}

TEST(ControllerCheck, CatchesPadding) {
  EXPECT_THAT(findings_of("looks_at_padding"),
              ElementsAre(is_finding("looks_at_padding/0", "memory hash", Repeat::again)));
}

TEST(ControllerCheck, CatchesAControllerThatLooksAtItsBatch) {
  EXPECT_THAT(findings_of("looks_at_its_batch"),
              ElementsAre(is_finding("looks_at_its_batch/0", "memory before", Repeat::again)));
}

// With several threads, another robot would decide before or after such a change.
TEST(ControllerCheck, CatchesChangesOfOtherRobots) {
  Swarm swarm({"changes_another"}, 1);
  ControllerCheck check(swarm.world, registry());
  swarm.world.step();
  const std::vector<ControllerFinding> findings = on_another_thread(check);
  ASSERT_THAT(findings, ElementsAre(is_finding("changes_another/0", "command turn", Repeat::other),
                                    is_finding("changes_another/0", "memory told", Repeat::other)));
  EXPECT_GT(findings[0].decisions, k_robots / 2) << "robots of the same batch, too";
  EXPECT_THAT(finding_text(swarm.world, findings[0]),
              MatchesRegex("controller \"changes_another/0\": command turn of \"r[0-9]+\" .id [0-9]+. is "
                           "changed from 0x0+ .0. to 0x3fe0+ .0.5. by the decision of another robot; [0-9]+ "
                           "changes"));
}

TEST(ControllerCheck, CatchesAFieldThatStartLeavesUnset) {
  Swarm swarm({"honest", "starts_half"});
  const ControllerCheck check(swarm.world, registry());
  const std::vector<ControllerFinding> findings = check.start_twice();
  ASSERT_THAT(findings, ElementsAre(is_finding("starts_half/1", "memory unset", Repeat::start)));
  EXPECT_EQ(finding_text(swarm.world, findings[0]),
            "controller \"starts_half/1\": memory unset of \"r0\" (id 1) is 0xa5a5a5a5 (-1515870811) when "
            "its memory is initialised in storage that held other bytes, not 0x5a5a5a5a (1515870810)");
}

TEST(ControllerCheck, OurOwnControllersAreFunctions) {
  test::SceneBuilder scene;
  const auto bot = [&](const std::string& name, ControllerSpec controller, std::size_t beams) {
    const TypeId type = scene.robot(name, {Solid{{test::box_ring(0.2, 0.2)}, {0, 0.3}}});
    std::vector<test::Transducer> ring;
    for (std::size_t i = 0; i < beams; ++i)
      ring.push_back(
          {.pose = {0, 0, 0.1, radians(360.0 / static_cast<double>(beams) * static_cast<double>(i))},
           .fov = beams == 1 ? 2.0 : 0.0,
           .samples = beams == 1 ? 31 : 1});
    scene[type].devices.push_back(test::ranger("eye", ring));
    scene[type].controllers.push_back(std::move(controller));
    for (int i = 0; i < 40; ++i)
      scene.body(fmt::format("{}{}", name, i), type,
                 {0.5 * (i % 8), 0.5 * (i / 8) + 3.0 * static_cast<double>(beams), 0, 0.7 * i});
  };
  bot("scanner", test::controller("wander"), 1);
  bot("ring", test::controller("expand"), 16);
  bot("blind", test::controller("script", {{"law", "wave"}}), 2);
  World world = scene.world();
  ControllerCheck check(world, test::registry());
  EXPECT_THAT(check.start_twice(), IsEmpty());
  for (int tick = 1; tick <= 20; ++tick) {
    world.step();
    ASSERT_THAT(on_another_thread(check), IsEmpty()) << tick;
  }
  EXPECT_EQ(check.decisions(), 20u * 120);
  EXPECT_GT(engine::mean_displacement(world), 0.1);
}

}  // namespace
}  // namespace troupe::engine::controller_check_test
