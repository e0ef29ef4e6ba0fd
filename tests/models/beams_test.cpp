// Controllers that use rangers by the directions of the beams: a robot does the same whatever the division
// of the beams into transducers, the order of the beams and the heading of the ranger are.

#include "models/controllers/beams.hpp"

#include "base/random.hpp"
#include "engine/world/world.hpp"
#include "models/controllers/evasion.hpp"
#include "models/controllers/scan_ahead.hpp"
#include "tests/support/devices.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/slow_build.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace troupe::models::beams_test {
namespace {

using engine::World;
using test::box;
using test::device;
using test::SceneBuilder;
using test::Transducer;
using Layout = engine::DeviceKind::Prepared;

// ---- the window of a scanner

double angle_of(double fov, std::size_t samples, std::size_t i) {
  return -fov / 2 + static_cast<double>(i) * (fov / static_cast<double>(samples - 1));
}

Layout fan(double fov, std::size_t samples) {
  Layout layout;
  layout.transducers = {{.first = 0, .samples = samples}};
  for (std::size_t i = 0; i < samples; ++i) layout.bearings.push_back(angle_of(fov, samples, i));
  return layout;
}

Scanner scanner_of(const Layout& layout, std::size_t share, Pose pose = {}) {
  return {engine::DeviceInfo{"laser", "ranger", layout, pose}, share};
}

/// Stage's law for a fan about straight ahead, by the places of its samples.
ScanAhead by_stage(const std::vector<float>& scan, std::size_t share, double min_front, double stop) {
  ScanAhead seen;
  const std::size_t n = scan.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (i > n / share && i < n - n / share) {
      seen.obstruction = seen.obstruction || scan[i] < min_front;
      seen.stop = seen.stop || scan[i] < stop;
    }
    float& side = i > n / 2 ? seen.left : seen.right;
    side = std::min(side, scan[i]);
  }
  return seen;
}

void expect_equal(const ScanAhead& a, const ScanAhead& b, const std::string& what) {
  EXPECT_EQ(a.obstruction, b.obstruction) << what;
  EXPECT_EQ(a.stop, b.stop) << what;
  EXPECT_EQ(a.left, b.left) << what;
  EXPECT_EQ(a.right, b.right) << what;
}

TEST(Scanner, OfAFanAheadItIsStagesLaw) {
  Random random(1, 2, 3, 4);
  for (std::size_t n = k_least_samples; n < 200; ++n)
    for (const std::size_t share : {3, 4})
      for (const double degrees : {1.0, 60.0, 90.0, 180.0, 200.0, 270.0, 330.0}) {
        const Layout layout = fan(radians(degrees), n);
        const Scanner scanner = scanner_of(layout, share);
        ASSERT_TRUE(scanner.is_usable()) << n << " beams over " << degrees;
        // One beam at a time that is near, so that each one's place shows.
        for (std::size_t near = 0; near < n; ++near) {
          std::vector<float> scan(n, 8.0f);
          scan[near] = 0.4f + 0.5f * static_cast<float>(random.uniform());
          const std::string what =
              fmt::format("beam {} of {} over {} degrees, share {}", near, n, degrees, share);
          expect_equal(scanner.ahead(scan, 0.7, 0.6), by_stage(scan, share, 0.7, 0.6), what);
          EXPECT_EQ(scanner.straight_ahead(scan), scan[n / 2]) << what;
        }
      }
}

TEST(Scanner, TheOrderOfTheBeamsDoesNotShow) {
  Random random(5, 6, 7, 8);
  for (const std::size_t n : {9, 16, 31}) {
    const Layout whole = fan(radians(180), n);
    std::vector<std::uint32_t> order(n);
    for (std::uint32_t i = 0; i < n; ++i) order[i] = i;
    std::span<std::uint32_t> all(order);
    random.shuffle(all);
    Layout mixed;
    for (std::size_t i = 0; i < n; ++i) {
      mixed.transducers.push_back({.first = i});
      // Some a whole turn on.
      mixed.bearings.push_back(whole.bearings[order[i]] + (i % 3 == 0 ? 2 * k_pi : 0));
    }
    const Scanner a = scanner_of(whole, 4);
    const Scanner b = scanner_of(mixed, 4);
    for (std::size_t near = 0; near < n; ++near) {
      std::vector<float> scan(n, 2.0f), mixed_scan(n, 2.0f);
      scan[order[near]] = mixed_scan[near] = 0.3f;
      expect_equal(a.ahead(scan, 0.5, 0.4), b.ahead(mixed_scan, 0.5, 0.4), fmt::format("{} of {}", near, n));
    }
  }
}

// A program may have told the robot to drive to a goal: its coordinates are no speeds.
TEST(Evasion, TurnsAwayWhateverTheModeOfTheLastCommand) {
  struct Memory {
    std::int32_t avoid_updates = 0;
    std::uint32_t still_updates = 0, escape_updates = 0;
    double x = 0, y = 0, heading = 0;
  };
  const Scanner scanner = scanner_of(fan(k_pi / 2, 9), Evasion::window_share);
  const std::vector<float> wall(9, 0.6f);
  const Evasion evasion;
  Random random(1, 2, 3, 4);
  for (const std::int32_t turning : {0, 3}) {
    Memory memory{.avoid_updates = turning};
    engine::Command command{7, 8, 3, engine::ControlMode::position};
    EXPECT_TRUE(evasion.avoids(memory, scanner, wall, random, command));
    EXPECT_EQ(command.mode, engine::ControlMode::velocity);
    EXPECT_EQ(command.x, evasion.avoid_speed);
    EXPECT_EQ(std::abs(command.turn), evasion.avoid_turn);
    const double turn = command.turn;
    EXPECT_TRUE(evasion.avoids(memory, scanner, wall, random, command));
    EXPECT_EQ(command.turn, turn) << "a turn goes on";
  }
  Memory memory;
  engine::Command command{7, 8, 3, engine::ControlMode::position};
  const engine::Percept percept;
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(evasion.escapes(memory, percept, random, command));
}

TEST(Evasion, ARobotIsNotStuckBeforeItsDriveHasRun) {
  struct Memory {
    std::uint32_t still_updates = 0, escape_updates = 0;
    double x = 0, y = 0, heading = 0;
  };
  const engine::Percept percept{.tick_s = 0.1, .period_s = 0.3};
  for (const auto& [drive_period, still] : {std::pair(1, 6), std::pair(15, 7), std::pair(16, 8)}) {
    const Evasion evasion{.drive_period = static_cast<std::uint64_t>(drive_period)};
    Memory memory;
    Random random(1, 2, 3, 4);
    engine::Command command{0.3, 0, 0};
    int decisions = 1;
    while (decisions < 100 && !evasion.escapes(memory, percept, random, command)) ++decisions;
    EXPECT_EQ(decisions, still) << drive_period;
  }
}

TEST(Scanner, LooksAheadWhereverItsFanIsTurnedTo) {
  const Layout side = [] {
    Layout layout = fan(radians(200), 41);  // from 10 degrees to the right of ahead to 190 to the left
    for (double& bearing : layout.bearings) bearing += radians(90);
    return layout;
  }();
  const Scanner scanner = scanner_of(side, 4);
  ASSERT_TRUE(scanner.is_usable());
  const auto look = [&](double degrees) {
    std::vector<float> scan(41, 5.0f);
    scan[static_cast<std::size_t>(std::lround((degrees + 10) / 5))] = 0.2f;
    return scanner.ahead(scan, 1, 0.5);
  };
  EXPECT_TRUE(look(0).obstruction);
  EXPECT_TRUE(look(-10).obstruction);
  EXPECT_TRUE(look(40).obstruction);
  EXPECT_FALSE(look(90).obstruction) << "the middle of the fan looks to the left";
  EXPECT_EQ(look(40).left, 0.2f);
  EXPECT_EQ(look(-10).right, 0.2f);
  EXPECT_EQ(look(0).right, 0.2f);

  // The same fan ahead, on a sensor that is turned by as much.
  const Scanner ahead = scanner_of(side, 4, {0, 0, 0, radians(-90)});
  std::vector<float> scan(41, 5.0f);
  scan[20] = 0.2f;
  EXPECT_TRUE(ahead.ahead(scan, 1, 0.5).obstruction);
  EXPECT_EQ(ahead.straight_ahead(scan), 0.2f);

  EXPECT_FALSE(scanner_of(side, 4, {0, 0, 0, radians(90)}).is_usable()) << "it looks back";
  EXPECT_FALSE(scanner_of(fan(radians(180), 8), 4).is_usable()) << "too few";
}

TEST(Scanner, ParallelBeamsTellLeftAndRightByWhereTheyStart) {
  Layout grille;
  for (int i = 0; i < 9; ++i) {
    grille.transducers.push_back(
        {.first = grille.bearings.size(), .pose_sensor_transducer = {0, 0.05 * (i - 4), 0, 0}});
    grille.bearings.push_back(0);
  }
  const Scanner scanner = scanner_of(grille, 3, {0.2, 1, 0, 0});
  ASSERT_TRUE(scanner.is_usable());
  for (std::size_t near = 0; near < 9; ++near) {
    std::vector<float> scan(9, 3.0f);
    scan[near] = 0.5f;
    const ScanAhead seen = scanner.ahead(scan, 1, 0.6);
    EXPECT_TRUE(seen.obstruction && seen.stop);
    EXPECT_EQ(seen.left, near > 4 ? 0.5f : 3.0f) << near;
    EXPECT_EQ(seen.right, near > 4 ? 3.0f : 0.5f) << near;
  }
}

TEST(Beams, KnowTheirBearingsAndOriginsInTheFrameOfTheDrive) {
  Layout layout;
  layout.transducers = {{.first = 0, .samples = 2, .pose_sensor_transducer = {0.1, 0, 0, 0}},
                        {.first = 2, .pose_sensor_transducer = {0, 0.2, 0, 0}}};
  layout.bearings = {-0.5, 0.5, k_pi};
  const auto beams = beams_of({"r", "ranger", layout, {1, 0, 0, k_pi / 2}});
  ASSERT_EQ(beams.size(), 3);
  EXPECT_EQ(beams[1].transducer, 0);
  EXPECT_EQ(beams[2].transducer, 1);
  EXPECT_DOUBLE_EQ(beams[1].bearing, k_pi / 2 + 0.5);
  EXPECT_NEAR(beams[2].bearing, -k_pi / 2, 1e-15);
  EXPECT_NEAR((beams[0].origin - Vec2(1, 0.1)).norm(), 0, 1e-15);
  EXPECT_NEAR((beams[2].origin - Vec2(0.8, 0)).norm(), 0, 1e-15);
}

// ---- the same geometry, said in several ways

/// A way to say it.
struct Form {
  std::vector<Transducer> transducers;
  Pose pose_body_device;
};

/// Beams of a fan, one transducer; `turned`: by that angle to the one side, and back to the other.
Form one_fan(double degrees, int samples, double turned = 0) {
  return {{{.pose = {0, 0, 0, -turned}, .range_max = 1.5, .fov = radians(degrees), .samples = samples}},
          {0, 0, 0.1, turned}};
}
/// The same, each beam a transducer.
Form singles(double degrees, int samples) {
  Form form{{}, {0, 0, 0.1, 0}};
  for (int i = 0; i < samples; ++i)
    form.transducers.push_back(
        {.pose = {0, 0, 0,
                  angle_of(radians(degrees), static_cast<std::size_t>(samples), static_cast<std::size_t>(i))},
         .range_max = 1.5});
  return form;
}
/// The same, from left to right.
Form backwards(Form form) {
  std::ranges::reverse(form.transducers);
  return form;
}

/// Robots with a ranger and with all else that the controllers want. `crowd`: several in a yard with walls;
/// else one in the open. `turned`: the heading of radio and finder on each robot, rad.
SceneBuilder robots(const engine::ControllerSpec& controller, const Form& form, bool crowd,
                    double turned = 0) {
  SceneBuilder scene;
  scene.spec.seed = 7;
  const engine::Returns unseen{.obstacle = false, .ranger = -1};
  const TypeId depot = scene.type("depot", {box(0.5, 0.5, 0.01)}, unseen);
  scene[depot].devices = {device("flags")};
  scene.body("source", depot, {-3, -3, 0, 0});
  scene.body("sink", depot, {3, 3, 0, 0});
  scene.body("red_source", depot, {-3, 3, 0, 0});
  scene.body("red_sink", depot, {3, -3, 0, 0});
  const TypeId gray = scene.type("gray", {box(60, 60, 0.01)}, unseen);
  scene[gray].parts[0].color = Color{0.5f, 0.5f, 0.5f, 1.0f};
  scene.body("floor", gray);
  const TypeId type = scene.robot("robot", {box(0.2, 0.2, 0.2)});
  scene[type].parts[0].returns.fiducial = 1;
  engine::DeviceSpec ranger = test::ranger("eyes", form.transducers);
  ranger.pose_body_device = form.pose_body_device;
  scene[type].devices = {ranger, device("ground"), device("radio", {{"range", 2.0}, {"payload", 4}}),
                         device("fiducial", {{"fov", 2 * k_pi}}), device("flags")};
  for (const std::size_t d : {2, 3}) scene[type].devices[d].pose_body_device = {0, 0, 0.1, turned};
  if (controller.kind == "collector") test::add_device(scene[type], "hand", "gripper", {0.2, 0, 0, 0});
  scene[type].controllers = {controller};
  for (int i = 0; i < (crowd ? 12 : 1); ++i)
    scene.body(fmt::format("r{}", i), type, {0.9 * (i % 4) - 1.4, 0.9 * (i / 4) - 0.8, 0, 0.7 * i});
  if (!crowd) return scene;
  scene.wall(-2.6, -2.4, 2.6, -2.3);
  scene.wall(-2.6, 2.3, 2.6, 2.4);
  scene.wall(-2.6, -2.3, -2.5, 2.3);
  scene.wall(2.5, -2.3, 2.6, 2.3);
  scene.wall(-0.5, 1.5, -0.4, 2.3);
  return scene;
}

std::vector<Pose> poses_of(const World& world) {
  std::vector<Pose> poses;
  for (std::size_t r = 0; r < world.view().rows(); ++r)
    if (world.view().type(Row(r)).drive) poses.push_back(world.view().poses()[r]);
  return poses;
}

struct Kind {
  std::string name;
  std::vector<std::pair<std::string_view, engine::Value>> params = {};
};
void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

engine::ControllerSpec controller_of(const Kind& kind) {
  return {.kind = kind.name,
          .params = test::record(test::registry().controller(kind.name)->params, kind.params)};
}

class OfRanges : public ::testing::TestWithParam<Kind> {
 protected:
  /// Poses of all robots, tick by tick.
  std::vector<std::vector<Pose>> run(const Form& form, bool crowd, int ticks, double turned = 0) const {
    World world = robots(controller_of(GetParam()), form, crowd, turned).world({.threads = 1});
    std::vector<std::vector<Pose>> log{poses_of(world)};
    for (int tick = 0; tick < ticks; ++tick) {
      world.step();
      log.push_back(poses_of(world));
    }
    return log;
  }
  /// Whether it adds up what its beams see: then the order of the beams shows in the last bits.
  bool has_sum() const {
    const std::string& name = GetParam().name;
    return name == "expand" || name == "pioneer_flocking" || name == "radio_flocking";
  }
};

double farthest(const std::vector<Pose>& a, const std::vector<Pose>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    most = std::max(most, (a[i].position() - b[i].position()).norm());
  return most;
}

TEST_P(OfRanges, OneFanDoesAsManyTransducersDo) {
  for (const auto& [degrees, samples] : {std::pair(180.0, 15), std::pair(120.0, 12), std::pair(270.0, 40)}) {
    const int ticks = test::k_slow_build ? 60 : 300;
    const auto fan = run(one_fan(degrees, samples), true, ticks);
    EXPECT_GT(farthest(fan.front(), fan.back()), 0.3) << "it does something";
    EXPECT_EQ(fan, run(singles(degrees, samples), true, ticks)) << degrees << " degrees";
    // Of a sum only the first seconds: what the last bits do to it grows.
    const auto mirrored = run(backwards(singles(degrees, samples)), true, ticks);
    const auto turned = run(one_fan(degrees, samples, k_pi / 2), true, ticks);
    if (has_sum()) {
      for (const auto* other : {&mirrored, &turned}) EXPECT_LT(farthest(fan[50], (*other)[50]), 1e-6);
    } else {
      EXPECT_EQ(fan, mirrored);
      EXPECT_EQ(fan, turned);
    }
  }
}

// Radios and finders read floats, so that the last digits differ.
TEST_P(OfRanges, TurnedRadiosAndFindersTellTheSame) {
  const int ticks = 40;
  const auto ahead = run(one_fan(180, 15), true, ticks);
  for (const double turned : {0.5, -2.0, k_pi})
    EXPECT_LT(farthest(ahead.back(), run(one_fan(180, 15), true, ticks, turned).back()), 1e-4) << turned;
}

TEST_P(OfRanges, ALoneRobotInTheOpenGoesSomewhere) {
  Form ring = singles(330, 12);
  for (const Form& form : {one_fan(180, 15), one_fan(90, 9), singles(180, 15), ring, one_fan(270, 180)}) {
    const auto log = run(form, false, 300);
    double most = 0;
    for (const std::vector<Pose>& poses : log) most = std::max(most, farthest(log.front(), poses));
    EXPECT_GT(most, 0.4) << form.transducers.size() << " transducers of " << form.transducers[0].samples;
  }
}

TEST_P(OfRanges, WhatLooksBackIsRefused) {
  if (GetParam().name == "radio_flocking") GTEST_SKIP() << "a scanner only pushes it away from walls";
  Form form = one_fan(90, 12);
  form.pose_body_device.heading = k_pi;
  const SceneBuilder scene = robots(controller_of(GetParam()), form, false);
  Diagnostics diagnostics;
  EXPECT_THAT(test::message_of<std::exception>(
                  [&] { World(scene.spec, test::registry(), {.threads = 1}, diagnostics); }),
              ::testing::HasSubstr("ahead"));
}

INSTANTIATE_TEST_SUITE_P(Controllers, OfRanges,
                         ::testing::Values(Kind{"expand"},
                                           Kind{"wander", {{"min_front", 0.5}, {"stop", 0.2}}},
                                           Kind{"pioneer_flocking"}, Kind{"radio_flocking"}, Kind{"beeclust"},
                                           Kind{"chain"}, Kind{"clustering"}, Kind{"collective_perception"},
                                           Kind{"informed_aggregation"}, Kind{"gradient"}, Kind{"collector"},
                                           Kind{"fasr"}, Kind{"fasr2", {{"task", std::string("red")}}}),
                         [](const auto& test) { return test.param.name; });

// ---- expand

/// Rooms of 4 m with doors of 1 m, 5 by 5; two robots to a square metre in the nine in the middle.
double mean_way_in_an_office(const Form& form) {
  SceneBuilder scene;
  scene.spec.seed = 3;
  for (int line = 0; line <= 5; ++line)
    for (int room = 0; room < 5; ++room) {
      const double at = 4.0 * line - 10;
      const double low = 4.0 * room - 10;
      const bool has_door = line > 0 && line < 5;
      for (const auto& [from, to] : has_door ? std::vector{std::pair(0.0, 1.5), std::pair(2.5, 4.0)}
                                             : std::vector{std::pair(0.0, 4.0)}) {
        scene.wall(low + from, at - 0.05, low + to, at + 0.05);
        scene.wall(at - 0.05, low + from, at + 0.05, low + to);
      }
    }
  const TypeId type = scene.robot("robot", {box(0.25, 0.25, 0.2)});
  engine::DeviceSpec ranger = test::ranger("eyes", form.transducers);
  ranger.pose_body_device = form.pose_body_device;
  scene[type].devices = {ranger};
  scene[type].controllers = {test::controller("expand")};
  Random random(3, 4, 5, 6);
  for (int i = 0; i < 200; ++i) {
    const int room = i % 9;
    const int place = i / 9;
    scene.body(fmt::format("r{}", i), type,
               {4.0 * (room % 3 - 1) - 1.3 + 0.65 * (place % 5),
                4.0 * (room / 3 - 1) - 1.3 + 0.65 * (place / 5), 0, random.uniform(-k_pi, k_pi)});
  }
  World world = scene.world({.threads = 1});
  const std::vector<Pose> start = poses_of(world);
  for (int tick = 0; tick < 600; ++tick) world.step();
  const std::vector<Pose> end = poses_of(world);
  double sum = 0;
  for (std::size_t i = 0; i < end.size(); ++i) sum += (end[i].position() - start[i].position()).norm();
  return sum / static_cast<double>(end.size());
}

Form reaching(Form form, double range_max) {
  for (Transducer& t : form.transducers) t.range_max = range_max;
  return form;
}

TEST(Expand, DispersesAnOfficeWhateverItsBeamsAreIn) {
  const double three = mean_way_in_an_office(reaching(singles(90, 3), 5));
  EXPECT_GT(three, 2);
  EXPECT_EQ(mean_way_in_an_office(reaching(one_fan(90, 3), 5)), three);
  for (const double degrees : {180.0, 225.0, 270.0})
    EXPECT_GT(mean_way_in_an_office(reaching(one_fan(degrees, 12), 5)), 2) << degrees;
}

TEST(Expand, ALoneRobotBeforeAWallTurnsAway) {
  for (const int samples : {3, 5}) {
    SceneBuilder scene;
    scene.wall(1, -50, 1.1, 50);
    const TypeId type = scene.robot("robot", {box(0.25, 0.25, 0.2)});
    scene[type].devices = {test::ranger("eyes", one_fan(90, samples).transducers)};
    scene[type].controllers = {test::controller("expand")};
    const BodyId body = scene.body("r", type);
    World world = scene.world({.threads = 1});
    double most = 0;
    for (int tick = 0; tick < 600; ++tick) {
      world.step();
      most = std::max(most, world.view().pose(body).position().norm());
    }
    EXPECT_GT(most, 3) << samples << " beams: along the wall, or back";
  }
}

}  // namespace
}  // namespace troupe::models::beams_test
