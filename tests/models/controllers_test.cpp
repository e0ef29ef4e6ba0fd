#include "models/controllers/decisions.hpp"
#include "models/drives/wheels.hpp"
#include "tests/support/devices.hpp"
#include "tests/support/scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace troupe::models::controllers_test {
namespace {

using engine::Command;

/// One decision of a controller kind on readings given by hand: a ring of single beams, or one scanner of 180
/// degrees.
struct Decision {
  engine::DeviceKind::Prepared layout;
  engine::ControllerKind kind;
  engine::ControllerKind::Prepared prepared;
  std::vector<std::byte> memory;
  std::string error;
  Command command{9, 9, 9};
  std::uint32_t tick = 1;
  double tick_s = 0.1;

  static engine::DeviceKind::Prepared ring(const std::vector<double>& headings) {
    engine::DeviceKind::Prepared layout;
    for (const double heading : headings) {
      layout.transducers.push_back({.first = layout.bearings.size()});
      layout.bearings.push_back(heading);
    }
    return layout;
  }
  static engine::DeviceKind::Prepared scanner(std::size_t samples) {
    engine::DeviceKind::Prepared layout;
    layout.transducers = {{.first = 0, .samples = samples}};
    for (std::size_t i = 0; i < samples; ++i)
      layout.bearings.push_back(k_pi * (static_cast<double>(i) / static_cast<double>(samples - 1) - 0.5));
    return layout;
  }

  Decision(engine::DeviceKind::Prepared sensor, const std::string& name, const engine::Record& params)
      : layout(std::move(sensor)), kind(*test::registry().controller(name)) {
    const engine::DeviceInfo info{"sensor", "ranger", layout};
    std::vector<bool> claimed(1, false);
    Result<engine::ControllerKind::Prepared> made = kind.prepare(params, {&info, 1}, claimed);
    if (made)
      prepared = *std::move(made);
    else
      error = made.error().text;
    memory.resize(kind.memory_bytes);
    kind.start(memory.data());
  }

  Command operator()(const std::vector<float>& ranges) {
    const Row row(std::size_t{0});
    const BodyId id(std::size_t{3});
    const std::uint32_t slot = 0;
    engine::DecideBatch batch{.tick = tick,
                              .time_s = tick_s * tick,
                              .tick_s = tick_s,
                              .period_s = tick_s,
                              .seed = 1,
                              .stream = 2,
                              .rows = {&row, 1},
                              .ids = {&id, 1},
                              .slots = {&slot, 1},
                              .commands = {&command, 1},
                              .devices = 1,
                              .memories = {memory.data(), memory.size()}};
    engine::StateTable readings(
        "sensor", engine::HashGroup::sensor, engine::StateTable::Layout::rows,
        {{"ranges", engine::Element::f32, static_cast<std::uint32_t>(ranges.size()), "m", ""}}, {id});
    std::ranges::copy(ranges, readings.cell<float>(0, 0).begin());
    batch.percepts[0] = &readings;
    kind.decide(prepared.data, batch);
    ++tick;
    return command;
  }
};

std::vector<double> swarm_headings() {
  std::vector<double> headings;
  for (int i = 0; i < 12; ++i) headings.push_back(radians(30 * i));
  return headings;
}

std::vector<double> pioneer_headings() {
  std::vector<double> headings;
  for (const double d : {90, 50, 30, 10, -10, -30, -50, -90, -90, -130, -150, -170, 170, 150, 130, 90})
    headings.push_back(radians(d));
  return headings;
}

engine::Record preset(const std::string& name) {
  const engine::Registry::Preset* preset = test::registry().preset(name);
  return test::record(test::registry().controller(preset->kind)->params, preset->params);
}

TEST(Expand, TurnsTowardsTheVectorSumWithGainOne) {
  Decision decide(Decision::ring(swarm_headings()), "expand", preset("expand_swarm"));
  std::vector<float> ranges(12, 1.0f);
  ranges[3] = 2.0f;  // free to the left
  ranges[0] = 2.0f;
  const Command c = decide(ranges);
  EXPECT_NEAR(c.turn, std::atan2(1.0, 1.0), 1e-6);
  EXPECT_EQ(c.x, 0) << "the sum lies outside the cone";
}

TEST(Expand, SwarmPresetLooksAtExactlyItsSevenBeams) {
  // Of 12 beams 0, 1, 2, 3, 9, 10 and 11 are looked at, and each by its own limit; comparisons are strict.
  const double d = 0.5;
  const std::vector<std::pair<int, double>> limits = {{0, d},     {1, d / 1.5}, {2, d / 3},   {3, d / 5},
                                                      {9, d / 5}, {10, d / 3},  {11, d / 1.5}};
  // The long readings ahead keep the vector sum within the cone, and off the x axis, whatever one beam reads.
  const auto decision = [](std::size_t beam, double reading) {
    Decision decide(Decision::ring(swarm_headings()), "expand", preset("expand_swarm"));
    std::vector<float> ranges(12, 1.0f);
    ranges[0] = ranges[11] = 4.0f;
    ranges[1] = 4.1f;
    ranges[beam] = static_cast<float>(reading);
    return decide(ranges);
  };
  for (int beam = 0; beam < 12; ++beam) {
    const auto limit = std::ranges::find(limits, beam, &std::pair<int, double>::first);
    for (const double factor : {0.999, 1.001}) {
      const double reading = factor * (limit == limits.end() ? 0.05 : limit->second);
      const Command c = decision(static_cast<std::size_t>(beam), reading);
      ASSERT_LT(std::abs(c.turn), 0.5) << "beam " << beam;
      EXPECT_EQ(c.x, limit != limits.end() && factor < 1 ? 0 : 0.3) << "beam " << beam << " at " << reading;
    }
  }
  EXPECT_EQ(decision(0, d).x, 0) << "exactly the limit";
}

TEST(Expand, PioneerPresetHasTheNumbersOfTheCaveBenchmark) {
  const double d = 0.75;
  const std::vector<std::pair<int, double>> limits = {{1, d / 4}, {2, d / 2}, {3, d},
                                                      {4, d},     {5, d / 2}, {6, d / 4}};
  for (const auto& [beam, limit] : limits) {
    for (const double factor : {0.999, 1.001}) {
      Decision decide(Decision::ring(pioneer_headings()), "expand", preset("expand_pioneer"));
      std::vector<float> ranges(16, 0.1f);
      for (int front = 1; front <= 6; ++front) ranges[static_cast<std::size_t>(front)] = 4;
      ranges[3] = 5;
      ranges[static_cast<std::size_t>(beam)] = static_cast<float>(limit * factor);
      const Command c = decide(ranges);
      ASSERT_LT(std::abs(c.turn), 0.5) << "beam " << beam;
      EXPECT_EQ(c.x, factor < 1 ? 0 : 0.2) << "beam " << beam;
    }
  }
}

TEST(Expand, WhereAllIsFreeItGoesStraightAhead) {
  const engine::Record defaults = test::registry().controller("expand")->params.defaults();
  Decision one(Decision::ring({0}), "expand", defaults);
  EXPECT_EQ(one({1.0f}).x, 0.3) << "one beam ahead: the sum has no sideways part at all";
  EXPECT_EQ(one({1.0f}).turn, 0);
  Decision ring(Decision::ring(swarm_headings()), "expand", defaults);
  const Command c = ring(std::vector<float>(12, 1.9f));
  EXPECT_EQ(c.x, 0.3) << "what is left of the sum is rounding, which has no direction";
  EXPECT_EQ(c.turn, 0);
}

TEST(Expand, StraightBeforeAWallItTurns) {
  Decision decide(Decision::ring({-0.5, 0, 0.5}), "expand",
                  test::registry().controller("expand")->params.defaults());
  const Command c = decide({1, 0.1f, 1});
  EXPECT_EQ(c.x, 0);
  EXPECT_EQ(c.turn, 0.5);
}

TEST(Expand, StagesExamplesKeepTheLastCommandOnAnAxis) {
  engine::Record params = preset("expand_swarm");
  const auto clearances =
      static_cast<std::size_t>(test::registry().controller("expand")->params.find("clearances"));
  params[clearances] = std::vector<double>{params[clearances].numbers().front()};  // one for its transducer
  Decision decide(Decision::ring({0}), "expand", params);
  EXPECT_EQ(decide({1.0f}).x, 9) << "one beam ahead: the sum has no sideways part at all";
}

TEST(Expand, EachBeamOfATransducerHasItsClearance) {
  // Two fans of three beams: only those of the first have a clearance.
  engine::DeviceKind::Prepared fans;
  fans.transducers = {{.first = 0, .samples = 3}, {.first = 3, .samples = 3}};
  fans.bearings = {-0.1, 0, 0.1, -0.3, 0.02, 0.3};
  const engine::Record params =
      test::record(test::registry().controller("expand")->params, {{"clearances", std::vector<double>{0.5}}});
  for (std::size_t near = 0; near < 6; ++near) {
    Decision decide(fans, "expand", params);
    std::vector<float> ranges(6, 2.0f);
    ranges[near] = 0.4f;
    EXPECT_EQ(decide(ranges).x, near < 3 ? 0 : 0.3) << near;
  }
}

TEST(Expand, WhatNeverPointsAheadIsAFault) {
  const std::string error =
      "needs a ranger with a beam ahead, or beams to the left and to the right: the vector sum of the "
      "beams of \"sensor\" never points ahead";
  for (const std::vector<double>& headings : {std::vector{k_pi}, {1.0}, {2.0, -2.0}, {0.6, 1.2, 2.9}})
    EXPECT_EQ(
        Decision(Decision::ring(headings), "expand", test::registry().controller("expand")->params.defaults())
            .error,
        error)
        << headings[0];
  for (const std::vector<double>& headings : {std::vector{0.4}, {1.5, -1.5}, {k_pi, 0.1}})
    EXPECT_EQ(
        Decision(Decision::ring(headings), "expand", test::registry().controller("expand")->params.defaults())
            .error,
        "")
        << headings[0];
}

TEST(Expand, InvertTurnsTheSumAround) {
  engine::Record params = preset("expand_swarm");
  const engine::FieldTable& table = test::registry().controller("expand")->params;
  params.at(static_cast<std::size_t>(table.find("invert"))) = true;
  Decision gather(Decision::ring(swarm_headings()), "expand", params);
  std::vector<float> ranges(12, 1.0f);
  ranges[4] = 2;  // free at 120 degrees: gathering goes to -60
  EXPECT_NEAR(gather(ranges).turn, radians(-60), 1e-6);
}

TEST(Expand, WithInvertTheSumMustBeAbleToPointBehind) {
  const engine::Record params =
      test::record(test::registry().controller("expand")->params, {{"invert", true}});
  for (const std::vector<double>& headings : {std::vector{0.0}, {2.0}, {-1.2, 0.3, 1.2}})
    EXPECT_EQ(
        Decision(Decision::ring(headings), "expand", params).error,
        "needs a ranger with a beam behind, or beams to the left and to the right: the vector sum of the "
        "beams of \"sensor\" never points behind")
        << headings[0];
  Decision behind(Decision::ring({k_pi - 0.2, -k_pi}), "expand", params);
  EXPECT_EQ(behind.error, "");
  EXPECT_EQ(behind({2, 2}).x, 0.3);
  EXPECT_EQ(Decision(Decision::ring({2.0, -2.0}), "expand", params).error, "");
}

TEST(Expand, WithoutARangerItSaysWhatItNeeds) {
  Decision decide({}, "expand", preset("expand_swarm"));
  EXPECT_EQ(decide.error,
            "needs a ranger that no other controller of the robot reads; the robot has no ranger");
  const engine::DeviceKind::Prepared layout = Decision::ring({0});
  const engine::DeviceInfo ranger{"eye", "ranger", layout};
  std::vector<bool> claimed(1, true);
  const auto made =
      test::registry().controller("expand")->prepare(preset("expand_swarm"), {&ranger, 1}, claimed);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().text, "needs a ranger that no other controller of the robot reads");
}

TEST(Wander, CruisesWithAFreeWay) {
  Decision decide(Decision::scanner(180), "wander", test::registry().controller("wander")->params.defaults());
  const Command c = decide(std::vector<float>(180, 8.0f));
  EXPECT_EQ(c.x, 0.4);
  EXPECT_EQ(c.turn, 0);
}

TEST(Wander, TurnsAwayFromTheNearerSideForTenToNineteenScans) {
  for (const bool left_nearer : {true, false}) {
    Decision decide(Decision::scanner(180), "wander",
                    test::registry().controller("wander")->params.defaults());
    std::vector<float> scan(180, 8.0f);
    scan[left_nearer ? 95 : 85] = 0.9f;  // scans run counter-clockwise: the upper half is the left
    const Command c = decide(scan);
    EXPECT_EQ(c.x, 0.05);
    EXPECT_EQ(c.turn, left_nearer ? -0.5 : 0.5);
    int scans = 1;
    while (decide(std::vector<float>(180, 8.0f)).x == 0.05) ++scans;
    EXPECT_GE(scans, 10);
    EXPECT_LE(scans, 19);
  }
}

TEST(Wander, StopsWhatIsTooNear) {
  Decision decide(Decision::scanner(9), "wander", test::registry().controller("wander")->params.defaults());
  EXPECT_EQ(decide({8, 8, 8, 8, 0.2f, 8, 8, 8, 8}).x, 0);
}

TEST(Wander, OutsideTheMiddleThirdNothingObstructs) {
  Decision decide(Decision::scanner(9), "wander", test::registry().controller("wander")->params.defaults());
  EXPECT_EQ(decide({0.1f, 0.1f, 0.1f, 0.1f, 8, 8, 0.1f, 0.1f, 0.1f}).x, 0.4);
}

TEST(Wander, NeedsMoreThanEightSamples) {
  Decision decide(Decision::scanner(8), "wander", test::registry().controller("wander")->params.defaults());
  EXPECT_EQ(
      decide.error,
      "needs a scanner: a ranger with at least 9 beams in total, at least one of which points within 30 "
      "degrees of straight ahead; \"sensor\" (8 beams) has too few beams");
}

TEST(Script, WaveFollowsItsLaw) {
  const engine::FieldTable& table = test::registry().controller("script")->params;
  Decision decide({}, "script", test::record(table, {{"law", "wave"}}));
  for (int n = 1; n <= 120; ++n) {
    const Command c = decide({});
    EXPECT_DOUBLE_EQ(c.x, 0.2 + 0.1 * ((n / 7) % 3));
    EXPECT_DOUBLE_EQ(c.turn, 0.4 * ((n / 11) % 5 - 2));
  }
}

TEST(Script, TimedLegsFollowOneAnotherAndThenItStands) {
  const engine::FieldTable& table = test::registry().controller("script")->params;
  const engine::FieldTable& leg = *table.fields[1].record;
  Decision decide({}, "script",
                  test::record(table, {{"legs", std::vector<engine::Record>{
                                                    test::record(leg, {{"until", 0.25}, {"forward", 1.0}}),
                                                    test::record(leg, {{"until", 0.35}, {"turn", 0.5}})}}}));
  EXPECT_EQ(decide({}).x, 1);
  EXPECT_EQ(decide({}).x, 1);
  EXPECT_EQ(decide({}).turn, 0.5);
  EXPECT_EQ(decide({}).turn, 0);
}

TEST(Script, ALegEndsOnItsTickThoughTimesAreNotExact) {
  // 3 * 0.3 is less than 0.9 in binary.
  const engine::FieldTable& table = test::registry().controller("script")->params;
  const engine::FieldTable& leg = *table.fields[1].record;
  Decision decide({}, "script",
                  test::record(table, {{"legs", std::vector<engine::Record>{test::record(
                                                    leg, {{"until", 0.9}, {"forward", 1.0}})}}}));
  decide.tick_s = 0.3;
  EXPECT_EQ(decide({}).x, 1);
  EXPECT_EQ(decide({}).x, 1);
  EXPECT_EQ(decide({}).x, 0);
}

TEST(Script, LegsMustFollowOneAnother) {
  const engine::FieldTable& table = test::registry().controller("script")->params;
  const engine::FieldTable& leg = *table.fields[1].record;
  const Decision decide(
      {}, "script",
      test::record(table, {{"legs", std::vector<engine::Record>{test::record(leg, {{"until", 5.0}}),
                                                                test::record(leg, {{"until", 2.0}})}}}));
  EXPECT_EQ(decide.error, "has a leg with an `until` of 2 s after a leg with 5 s: times must increase");
}

TEST(Expand, MoreClearancesThanTransducersIsAFault) {
  const Decision decide(Decision::ring({0, 1}), "expand", preset("expand_pioneer"));
  EXPECT_EQ(decide.error,
            "has 7 clearances for the 2 transducers of \"sensor\": give at most one for each transducer");
}

TEST(Script, LegsEndAtTheNearestRunOfASlowDrive) {
  // The drive runs at 0.9 s, 1.9 s and so on. It obeys the command of the run before.
  test::SceneBuilder scene;
  const TypeId type = scene.robot("bot", {test::box(0.2, 0.2)});
  scene[type].drive->period_s = 1;
  scene[type].controllers = {
      test::drive_legs({test::leg(4, 0), test::leg(6.3, 1), test::leg(7.5, -1), test::leg(8, 0.5)})};
  const BodyId body = scene.body("r", type);
  engine::World world = scene.world();
  const auto x_at = [&](std::size_t tick) {
    while (world.tick() < tick) world.step();
    return world.view().pose(body).x;
  };
  EXPECT_EQ(x_at(39), 0);
  EXPECT_NEAR(x_at(40), 0.1, 1e-9) << "3.9 s is nearest to 4 s";
  EXPECT_NEAR(x_at(59), 2, 1e-9) << "5.9 s is nearest to 6.3 s";
  EXPECT_NEAR(x_at(69), 1, 1e-9) << "6.9 s and 7.9 s are nearest to 7.5 s and 8 s";
  EXPECT_NEAR(x_at(79), 0, 1e-9);
  EXPECT_NEAR(x_at(100), 0, 1e-9);
}

TEST(Script, LegsOfAPartWithWheelsDoNotDependOnTheDriveOfItsBody) {
  test::SceneBuilder scene;
  const TypeId type = scene.robot("bot", {test::box(0.2, 0.2)});
  scene[type].parts.push_back({.name = "cart", .solids = {test::box(0.1, 0.1)}});
  const std::size_t wheels = test::add_device(scene[type], "cart", "wheels", {});
  scene[type].devices[wheels].part = 1;
  scene[type].parts[1].joint = scene[type].devices[wheels].moves;
  scene[type].drive->period_s = 0.5;
  scene[type].controllers = {test::drive_legs({test::leg(1.2, 1)})};
  scene[type].controllers[0].part = 1;
  const BodyId body = scene.body("r", type);
  engine::World world = scene.world();
  for (int tick = 0; tick < 30; ++tick) world.step();
  const Row row = world.view().row(body);
  // It decides at 0.5 s, 1 s and 1.5 s, and a command acts in the next tick.
  EXPECT_NEAR(
      world.tables()[world.view().type(row).devices[wheels].table].as<WheelsState>(world.view().slot(row)).x,
      1, 1e-9);
}

TEST(Script, TimedWithoutLegsIsAFault) {
  Decision decide({}, "script", test::registry().controller("script")->params.defaults());
  EXPECT_EQ(decide.error, "needs `legs` for the law `timed`");
}

/// Of each x, y, z and heading; and, where they are given, time, speed and wait.
engine::Record goals(std::vector<engine::Record> poses, bool again) {
  for (engine::Record& goal : poses) goal.resize(7, 0.0);
  return test::record(test::registry().controller("waypoints")->params,
                      {{"goals", std::move(poses)}, {"again", again}});
}

TEST(Waypoints, GoesFromGoalToGoalAndBeginsAgainWhereItShould) {
  for (const bool again : {true, false}) {
    test::SceneBuilder scene;
    const TypeId type = scene.robot("bot", {Solid{{test::box_ring(0.2, 0.2)}, {0, 0.3}}}, "omni");
    scene[type].controllers.push_back(
        {.kind = "waypoints", .params = goals({{1.0, 0.0, 0.0, 0.0}, {1.0, 1.0, 0.0, 0.5}}, again)});
    const BodyId body = scene.body("r", type);
    engine::World world = scene.world();
    // 1 m at 0.4 m/s, slower within 0.4 m: at the first goal, within 0.1 m, after some 3 s; so each metre.
    while (world.tick() < 28) world.step();
    EXPECT_EQ(world.view().pose(body).y, 0);
    while (world.tick() < 58) world.step();
    EXPECT_NEAR(world.view().pose(body).x, 1, 0.1);
    EXPECT_NEAR(world.view().pose(body).y, 0.85, 0.15);
    while (world.tick() < 88) world.step();
    EXPECT_NEAR(world.view().pose(body).y, again ? 0.1 : 1, again ? 0.1 : 0.02);
    EXPECT_NEAR(world.view().pose(body).heading, again ? 0.1 : 0.5, again ? 0.1 : 0.02);
  }
}

TEST(Waypoints, NeedsGoals) {
  std::vector<bool> claimed;
  EXPECT_EQ(test::registry().controller("waypoints")->prepare(goals({}, false), {}, claimed).error().text,
            "needs at least one goal in `goals`");
}

TEST(Decisions, AreTheNumberOfPeriodsInADuration) {
  EXPECT_EQ(whole_decisions(2.55, 0.1), 25u);
  EXPECT_EQ(whole_decisions(1, 2.5), 0u);
  EXPECT_EQ(whole_decisions(1e6, 1e-6), k_most_decisions);
  // 0.3 / 0.1 is not exactly 3 in binary.
  for (const auto& [seconds, count] :
       {std::pair(0.3, 3u), {0.7, 7u}, {0.8, 8u}, {1.5, 15u}, {2.0, 20u}, {3.0, 30u}}) {
    EXPECT_EQ(whole_decisions(seconds, 0.1), count) << seconds;
    EXPECT_EQ(decisions_for(seconds, 0.1), count) << seconds;
  }
  EXPECT_EQ(decisions_for(1.5, 0.02), 75u);
  EXPECT_EQ(decisions_for(1.5, 1), 2u);
  EXPECT_EQ(decisions_for(1.5, 10), 1u);
  EXPECT_EQ(decisions_for(1e6, 1e-6), k_most_decisions);
  Random random(1, 2, 3, 4);
  std::vector<std::uint32_t> drawn;
  for (int i = 0; i < 400; ++i) drawn.push_back(random_decisions(0.5, 1.5, 0.1, random));
  EXPECT_EQ(std::ranges::min(drawn), 5u);
  EXPECT_EQ(std::ranges::max(drawn), 19u);
}

/// A robot with all devices that the controllers of the literature need. It faces a wall, whose surface is
/// `ahead` m from its origin.
struct BeforeAWall {
  test::SceneBuilder scene;
  BodyId body;

  BeforeAWall(const std::string& kind, double ahead, double min_front, double tick_s,
              double sensor_period_s = 0) {
    scene.spec.tick_s = tick_s;
    scene.wall(ahead, -5, ahead + 0.1, 5);
    const TypeId type = scene.robot("robot", {test::box(0.1, 0.1, 0.1)});
    for (const std::string sensor : {"ground", "radio"})
      scene[type].devices.push_back({.name = sensor,
                                     .kind = sensor,
                                     .params = test::record(test::registry().device(sensor)->params, {}),
                                     .period_s = sensor_period_s});
    engine::FieldTable radio = test::registry().device("radio")->params;
    scene[type].devices[1].params = test::record(radio, {{"range", 1.0}, {"payload", 4}});
    scene[type].devices.push_back(
        test::ranger("eyes", {{.pose = {0, 0, 0.05, 0}, .range_max = 1, .fov = k_pi, .samples = 19}}));
    scene[type].controllers = {test::controller(kind, {{"min_front", min_front}})};
    body = scene.body("r", type);
  }
};

TEST(Controllers, TurnAwayFromWallsHoweverRarelyTheyDecide) {
  for (const std::string kind : {"beeclust", "informed_aggregation"}) {
    const BeforeAWall robot(kind, 1, 0.4, 0.1, 2.5);
    engine::World world = robot.scene.world();
    for (int tick = 0; tick < 300; ++tick) {
      world.step();
      ASSERT_EQ(world.view().counts().stalled, 0u) << kind << " in tick " << tick;
    }
    EXPECT_LT(world.view().pose(robot.body).x, 0.5) << kind;
  }
}

TEST(Controllers, TurnAwayForSecondsInShortTicksToo) {
  for (const std::string kind : {"chain", "gradient"}) {
    const BeforeAWall robot(kind, 0.15, 0.13, 0.02);
    engine::World world = robot.scene.world();
    const Row row = world.view().row(robot.body);
    const auto turns = [&] { return world.view().commands()[row.index()].turn != 0; };
    for (int tick = 0; tick < 1000 && !turns(); ++tick) world.step();
    ASSERT_TRUE(turns()) << kind;
    const engine::World::Placed in_the_open{row, {-50, 0, 0, 0}};
    world.set_poses({&in_the_open, 1});
    int ticks = 0;
    for (; turns() && ticks < 1000; ++ticks) world.step();
    EXPECT_GE(ticks, 25) << kind << ": 0.5 s";
    EXPECT_LE(ticks, 125) << kind << ": 2.5 s";
  }
}

TEST(Controllers, DoNotTakeASlowDriveForAnObstacle) {
  for (const std::string kind : {"clustering", "informed_aggregation"}) {
    BeforeAWall robot(kind, 10, 0.15, 0.1);
    robot.scene.spec.types.back().drive->period_s = 1.5;
    engine::World world = robot.scene.world();
    const Row row = world.view().row(robot.body);
    for (int tick = 0; tick < 100; ++tick) {
      world.step();
      ASSERT_GE(world.view().commands()[row.index()].x, 0) << kind << " backs out in tick " << tick;
    }
    EXPECT_GT(world.view().pose(robot.body).x, 0.3) << kind;
  }
}

TEST(Chain, NeedsADriveInTheRoleOfARobotAlone) {
  const auto error_in = [](const std::string& role) {
    BeforeAWall robot("chain", 0.15, 0.13, 0.1);
    engine::TypeSpec& type = robot.scene.spec.types.back();
    type.drive.reset();
    type.controllers = {test::controller("chain", {{"role", role}})};
    return robot.scene.error();
  };
  EXPECT_THAT(error_in("robot"),
              testing::HasSubstr("controller \"chain\" needs a drive for the role \"robot\""));
  EXPECT_EQ(error_in("nest"), "");
  EXPECT_EQ(error_in("prey"), "");
}

TEST(Controllers, ADeviceOfAnotherControllerIsNamedWhereItIsMissed) {
  BeforeAWall robot("gradient", 1, 0.4, 0.1);
  std::vector<engine::ControllerSpec>& controllers = robot.scene.spec.types.back().controllers;
  controllers.push_back(test::controller("radio_flocking", {}));
  EXPECT_THAT(
      robot.scene.error(),
      testing::HasSubstr("controller \"radio_flocking\" needs a radio with a payload of 4 bytes or more; "
                         "\"radio\" is used by another controller"));
  controllers.back() = test::controller("sink", {});
  EXPECT_THAT(robot.scene.error(), testing::EndsWith("controller \"sink\" needs a device of kind \"flags\""));
}

TEST(Controllers, WhatARobotOrItsWorldLacksIsNamed) {
  const auto error_of = [](const std::vector<std::string>& devices, engine::ControllerSpec controller) {
    BeforeAWall robot("gradient", 1, 0.4, 0.1);
    engine::TypeSpec& type = robot.scene.spec.types.back();
    for (const std::string& kind : devices) test::add_device(type, kind, kind, {});
    type.controllers = {std::move(controller)};
    return robot.scene.error();
  };
  using testing::EndsWith;
  EXPECT_THAT(error_of({}, test::controller("collector")),
              EndsWith("controller \"collector\" needs a fiducial finder (a device of kind \"fiducial\")"));
  EXPECT_THAT(error_of({"fiducial"}, test::controller("collector")),
              EndsWith("controller \"collector\" needs a gripper (a device of kind \"gripper\")"));
  EXPECT_THAT(error_of({"fiducial", "gripper"}, test::controller("collector")),
              EndsWith("controller \"collector\" needs a model in the world named \"sink\", or several named "
                       "\"sink0\", \"sink1\" and so on"));
  for (const std::string mark : {"puck", "charger"})
    EXPECT_THAT(error_of({"fiducial", "gripper"}, test::controller("collector", {{mark, std::int64_t{0}}})),
                EndsWith("controller \"collector\" has a `" + mark +
                         "` of 0, but 0 is the fiducial_return of models that have no mark: give another "
                         "number"));
  EXPECT_THAT(
      error_of({}, test::controller("pioneer_flocking")),
      EndsWith("controller \"pioneer_flocking\" needs a fiducial finder (a device of kind \"fiducial\")"));
  EXPECT_THAT(error_of({}, test::controller("fasr2")),
              EndsWith("controller \"fasr2\" has no task: give `task`; with the value \"red\", the robot "
                       "carries flags from the model red_source to the model red_sink"));
  EXPECT_THAT(error_of({"flags"}, test::controller("fasr2", {{"task", "red"}})),
              EndsWith("controller \"fasr2\" needs a model in the world named \"red_source\""));
  EXPECT_THAT(error_of({}, test::controller("operate")),
              EndsWith("controller \"operate\" has no orders: give `orders` (in a .world file: `plan`)"));
}

TEST(Wander, TakesOverARobotThatWasSentSomewhere) {
  Decision decide(Decision::scanner(31), "wander", test::registry().controller("wander")->params.defaults());
  decide.command = {3, 4, 0.5, engine::ControlMode::position};
  // In its way, so that it changes single numbers of the command.
  EXPECT_EQ(decide(std::vector<float>(31, 0.1f)).mode, engine::ControlMode::velocity);
}

// ---- radio: commands worked out by hand from the formulas in the headers of the controllers

constexpr double k_own = 0.5;  // rad: heading of the robot that decides, at the origin

/// A point in this direction (rad, world frame) at this distance (m) from the origin.
Vec2 towards(double direction, double distance) {
  return distance * Vec2(std::cos(direction), std::sin(direction));
}

engine::DeviceSpec radio_turned_by(double heading) {
  return test::device("radio", {{"range", 5.0}, {"walls", std::string("pass")}}, {0, 0, 0, heading});
}

/// The command that the robot `body` gives in the second tick: of what the others say in the first one, from
/// where all stood at the start, because no command of the first tick has moved them yet.
Command second_command(const test::SceneBuilder& scene, BodyId body) {
  engine::World world = scene.world({.threads = 1});
  world.step();
  world.step();
  return world.view().commands()[world.view().row(body).index()];
}

TEST(RadioFlocking, FollowsTheSumOfHeadingsDistancesAndObstacles) {
  test::SceneBuilder scene;
  const TypeId type = scene.robot("bot", {test::box(0.05, 0.05)});
  scene[type].devices = {
      radio_turned_by(0.75),
      test::ranger("eyes", {{}, {.pose = {0, 0, 0, k_pi / 2}}, {.pose = {0, 0, 0, -k_pi / 2}}})};
  scene[type].controllers = {test::controller(
      "radio_flocking",
      {{"speed", 0.25}, {"distance", 0.6}, {"spacing_weight", 2.0}, {"gain", 1.5}, {"clearance", 0.8}})};
  const BodyId robot = scene.body("r", type, {0, 0, 0, k_own});
  struct Other {
    double direction, distance, heading, weight;
  };
  // The weight is 1 - (0.6 / distance)^2, from -5 to 0.3.
  const std::vector<Other> others{{2.75, 0.5, 1.25, -0.44}, {-2, 0.2, -2.5, -5}, {1.25, 3, 0, 0.3}};
  Vec2 headings(1, 0), spacing(0, 0);  // frame of the robot
  for (const Other& other : others) {
    const Vec2 at = towards(other.direction, other.distance);
    scene.body("o" + std::to_string(scene.spec.bodies.size()), type, {at.x(), at.y(), 0, other.heading});
    headings += towards(other.heading - k_own, 1);
    spacing += other.weight * towards(other.direction - k_own, 1);
  }
  // Walls of 0.1 m across two of the three beams: 0.2 m ahead, and 0.4 m to the left.
  const TypeId wall = scene.type("wall", {test::box(0.1, 0.1)});
  const Vec2 ahead = towards(k_own, 0.25), left = towards(k_own + k_pi / 2, 0.45);
  scene.body("ahead", wall, {ahead.x(), ahead.y(), 0, k_own});
  scene.body("left", wall, {left.x(), left.y(), 0, k_own});
  const Vec2 push = -3.0 / 2 * Vec2(1 - 0.2 / 0.8, 1 - 0.4 / 0.8);

  const Vec2 aim = headings / headings.norm() + 2.0 / 3 * spacing + push;
  const double angle = std::atan2(aim.y(), aim.x());
  const Command command = second_command(scene, robot);
  EXPECT_NEAR(command.turn, 1.5 * angle, 1e-5);
  EXPECT_NEAR(command.x, 0.25 * std::max(-0.5, std::cos(angle)), 1e-5);
  EXPECT_EQ(command.y, 0);
}

TEST(RadioFlocking, DrivesBackwardsAtHalfItsSpeedAtMost) {
  test::SceneBuilder scene;
  const TypeId type = scene.robot("bot", {test::box(0.05, 0.05)});
  scene[type].devices = {radio_turned_by(0)};
  scene[type].controllers = {test::controller("radio_flocking", {{"speed", 0.25}, {"spacing_weight", 1.0}})};
  const BodyId robot = scene.body("r", type, {0, 0, 0, 0});
  scene.body("o", type, {0.1, 0, 0, 0});  // repels with a weight of 5
  const Command command = second_command(scene, robot);
  EXPECT_DOUBLE_EQ(command.x, -0.125);
  EXPECT_NEAR(std::abs(command.turn), k_pi, 1e-6);
}

/// A world of robots with the controller `brazil_nut`, radii as given, and a lamp.
struct Discs {
  test::SceneBuilder scene;
  TypeId disc(double radius, double taxis, double noise, double shake = 1) {
    const TypeId type =
        scene.robot("disc" + std::to_string(scene.spec.types.size()), {test::box(0.05, 0.05)});
    scene[type].devices = {test::device("light_sensor", {{"occlusion", false}}, {0, 0, 0, 0.25}),
                           radio_turned_by(-0.75)};
    scene[type].controllers = {test::controller("brazil_nut", {{"radius", radius},
                                                               {"speed", 0.125},
                                                               {"gain", 2.0},
                                                               {"taxis", taxis},
                                                               {"noise", noise},
                                                               {"push", 8.0},
                                                               {"shake", shake}})};
    return type;
  }
};

TEST(BrazilNut, FollowsTheSumOfLightAndRepulsions) {
  for (const double radius_of_other : {0.5, 0.125}) {
    Discs discs;
    const BodyId robot = discs.scene.body("r", discs.disc(0.25, 0.75, 0), {0, 0, 0, k_own});
    const Vec2 other = towards(-1, 0.6), far = towards(3, 0.8), lamp = towards(2.25, 2);
    discs.scene.body("o", discs.disc(radius_of_other, 0.75, 0), {other.x(), other.y(), 0, 0});
    discs.scene.body("f", discs.disc(0.5, 0.75, 0), {far.x(), far.y(), 0, 0});  // 0.8 m is beyond both radii
    const TypeId post = discs.scene.type("lamp", {test::box(0.1, 0.1)});
    discs.scene[post].devices = {test::device("blinkenlight", {{"intensity", 3.0}})};
    discs.scene.body("lamp", post, {lamp.x(), lamp.y(), 0, 0});
    Vec2 aim = 0.75 * towards(2.25 - k_own, 1);
    const double both = 0.25 + radius_of_other;
    if (0.6 < both) aim -= 8 * (1 - 0.6 / both) * towards(-1 - k_own, 1);
    const double angle = std::atan2(aim.y(), aim.x());
    const Command command = second_command(discs.scene, robot);
    EXPECT_NEAR(command.turn, 2 * angle, 1e-5) << radius_of_other;
    EXPECT_NEAR(command.x, 0.125 * std::min(aim.norm(), 1.0) * std::cos(angle), 1e-6) << radius_of_other;
  }
}

TEST(BrazilNut, IsShakenInADirectionOfTheWorldThatChangesWithItsTime) {
  Discs discs;
  const BodyId robot = discs.scene.body("r", discs.disc(0.25, 0, 1, 0.5), {0, 0, 0, k_own});
  engine::World world = discs.scene.world({.threads = 1});
  std::vector<double> directions;  // world frame
  for (int tick = 0; tick < 15; ++tick) {
    const Row row = world.view().row(robot);
    // It decides before it moves: at the pose after the tick before.
    const double heading = world.view().pose(robot).heading;
    world.step();
    directions.push_back(wrap_angle(heading + world.view().commands()[row.index()].turn / 2));
  }
  for (std::size_t i = 0; i < 15; ++i)
    EXPECT_NEAR(wrap_angle(directions[i] - directions[i - i % 5]), 0, 1e-9) << i;
  EXPECT_GT(std::abs(wrap_angle(directions[5] - directions[0])), 1e-3);
  EXPECT_GT(std::abs(wrap_angle(directions[10] - directions[5])), 1e-3);
}

TEST(Gradient, CountsTheHopsAndCountsAgainWhenARobotFails) {
  // A beacon, and robots without rangers, which are settled from the start, in a line of 1 m steps.
  test::SceneBuilder scene;
  scene.spec.mortal = true;
  std::vector<BodyId> robots;
  for (int i = 0; i < 5; ++i) {
    const TypeId type = scene.type("t" + std::to_string(i), {test::box(0.2, 0.2)});
    scene[type].devices = {test::device("radio", {{"range", 1.5}})};
    scene[type].controllers = {test::controller("gradient", {{"beacon", i == 0}, {"patience", 5}})};
    robots.push_back(scene.body("r" + std::to_string(i), type, {1.0 * i, 0, 0, 0}));
  }
  engine::World world = scene.world({.threads = 1});
  const auto hops = [&](std::size_t i) {
    const Row row = world.view().row(robots[i]);
    const engine::StateTable& table = world.tables()[*world.view().type(row).controllers[0].table];
    return table.number(world.view().slot(row), 0, 0);
  };
  for (int tick = 0; tick < 10; ++tick) world.step();
  for (std::size_t i = 0; i < robots.size(); ++i) EXPECT_EQ(hops(i), i);
  world.set_disabled(world.view().row(robots[1]), true);
  for (int tick = 0; tick < 5; ++tick) world.step();
  EXPECT_EQ(hops(2), 2) << "its patience lasts five decisions";
  for (int tick = 0; tick < 20; ++tick) world.step();
  EXPECT_GT(hops(2), 3) << "it hears robots only that have counted by it";
  world.set_disabled(world.view().row(robots[1]), false);
  for (int tick = 0; tick < 10; ++tick) world.step();
  for (std::size_t i = 0; i < robots.size(); ++i) EXPECT_EQ(hops(i), i) << "a lower count holds at once";
}

TEST(Chain, TheNestHasAPathWhereItHearsThePrey) {
  for (const double distance : {0.9, 1.1}) {
    test::SceneBuilder scene;
    std::vector<BodyId> ends;
    for (const std::string role : {"nest", "prey"}) {
      const TypeId type = scene.type(role, {test::box(0.2, 0.2)});
      scene[type].devices = {test::device("radio", {{"range", 1.0}})};
      scene[type].controllers = {test::controller("chain", {{"role", role}})};
      ends.push_back(scene.body(role, type, {ends.empty() ? 0 : distance, 0, 0, 0}));
    }
    engine::World world = scene.world({.threads = 1});
    for (int tick = 0; tick < 3; ++tick) world.step();
    const Row row = world.view().row(ends[0]);
    const engine::StateTable& table = world.tables()[*world.view().type(row).controllers[0].table];
    EXPECT_EQ(table.cell<std::uint8_t>(world.view().slot(row), 2)[0], distance < 1 ? 1 : 0) << distance;
  }
}

}  // namespace
}  // namespace troupe::models::controllers_test
