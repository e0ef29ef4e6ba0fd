// Pushing in small worlds, with distances that were computed by hand.

#include "engine/world/world.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/troupe.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

namespace troupe::pushing_test {
namespace {

using ::testing::HasSubstr;

/// Robots are boxes of 0.4 m x 0.3 m, pucks boxes of 0.1 m, walls of 0.02 m x 4 m lie across +x.
constexpr std::string_view k_types = R"(
  "types": {
    "robot": {"size_m": [0.4, 0.3, 0.3], "drive": {"kind": "diff"}},
    "weak": {"size_m": [0.4, 0.3, 0.3], "drive": {"kind": "diff", "pushes": 2}},
    "blocked": {"size_m": [0.4, 0.3, 0.3], "drive": {"kind": "diff", "pushes": 0}},
    "puck": {"size_m": [0.1, 0.1, 0.1], "pushable": true},
    "grippable": {"size_m": [0.1, 0.1, 0.1], "gripper_return": true},
    "hand": {"size_m": [0.1, 0.1, 0.1], "pushable": true, "devices": [
      {"name": "gripper", "kind": "gripper", "paddle_size": [0.5, 0.2, 0.4]}]},
    "wall": {"size_m": [0.02, 4, 0.5]}
  })";

class Pushing : public test::ScratchTest {
 protected:
  /// models: (name, type, x, y, heading in degrees).
  struct Thing {
    std::string_view name, type;
    double x, y = 0, heading = 0;
  };
  Simulation world(std::initializer_list<Thing> things, std::string_view more = "", unsigned threads = 1) {
    std::string models;
    for (const Thing& t : things)
      models += fmt::format(
          R"({}{{"name": "{}", "type": "{}", "pose": {{"x_m": {}, "y_m": {}, "heading_deg": {}}}}})",
          models.empty() ? "" : ", ", t.name, t.type, t.x, t.y, t.heading);
    const auto file =
        write("world.json", fmt::format(R"({{"troupe": 1,{},{} "models": [{}]}})", k_types, more, models));
    return Simulation(file, {.threads = threads});
  }
  static void drive(Simulation& simulation, const char* robot, double speed, int ticks, double turn = 0) {
    simulation.find(robot).set_speed(speed, 0, turn);
    for (int tick = 0; tick < ticks; ++tick) simulation.step();
  }
};

// 0.4 m to go until its front, 0.2 m before its origin, meets the puck's back at 0.6 m; then 0.75 m more with
// the puck before it: 0.65 m + 0.75 m = 1.40 m.
TEST_F(Pushing, APuckEndsWhereTheRobotsFrontLeavesIt) {
  for (const char* ranging : {"exact", "grid"}) {
    Simulation simulation =
        world({{"r", "robot", 0}, {"p", "puck", 0.65, 0.04}}, fmt::format(R"("ranging": "{}",)", ranging));
    drive(simulation, "r", 0.5, 23);
    EXPECT_NEAR(simulation.find("r").pose().x, 1.15, 1e-9);
    EXPECT_NEAR(simulation.find("p").pose().x, 1.40, 0.005);
    EXPECT_EQ(simulation.find("p").pose().y, 0.04);
    drive(simulation, "r", 0, 10);
    EXPECT_NEAR(simulation.find("p").pose().x, 1.40, 1e-6) << "it does not go on by itself";
    drive(simulation, "r", -0.5, 5);
    EXPECT_NEAR(simulation.find("p").pose().x, 1.40, 1e-6) << "nor does it stick";
  }
}

// A body with its arm out reaches farther than with its joints at rest. Two robots that are far apart push
// the arm and a puck towards each other: the robot that is resolved second must see what the first has
// pushed.
TEST_F(Pushing, AnArmThatIsOutHandsOnWhatIsPushed) {
  constexpr int k_lanes = 24;
  std::string models;
  for (int lane = 0; lane < k_lanes; ++lane)
    for (const auto& [name, type, x, heading] :
         {std::tuple("a", "robot", 0.0, 0), std::tuple("c", "crane", 0.26, 0),
          std::tuple("p", "puck", 3.37, 0), std::tuple("b", "robot", 3.63, 180)})
      models += fmt::format(
          R"({}{{"name": "{}{}", "type": "{}", "pose": {{"x_m": {}, "y_m": {}, "heading_deg": {}}}}})",
          models.empty() ? "" : ", ", name, lane, type, x, 10 * lane, heading);
  const auto file = write("cranes.json", fmt::format(R"({{"troupe": 1, {}, "models": [{}]}})",
                                                     std::string(k_types).substr(0, k_types.rfind('}')) +
                                                         R"(,
    "crane": {"size_m": [0.1, 0.1, 0.1], "pushable": true, "devices": [
      {"name": "arm", "kind": "actuator", "max_position": 3, "start_position": 3, "size_m": [0.1, 0.1, 0.1]}]}})",
                                                     models));
  std::optional<std::vector<double>> first;
  for (const auto& [threads, tile_m] : {std::pair(1u, 0.0), std::pair(2u, 0.0), std::pair(2u, 1.0)}) {
    Simulation simulation(file, {.threads = threads, .tile_size_m = tile_m});
    std::vector<double> places;
    for (int tick = 0; tick < 20; ++tick) {
      for (int lane = 0; lane < k_lanes; ++lane)
        for (const char* name : {"a", "b"})
          simulation.find(fmt::format("{}{}", name, lane)).set_speed(0.3, 0, 0);
      simulation.step();
      for (int lane = 0; lane < k_lanes; ++lane) {
        const auto x = [&](const char* name) {
          return simulation.find(fmt::format("{}{}", name, lane)).pose().x;
        };
        constexpr double k_touching_m = 1e-6;
        EXPECT_GE(x("c") - 0.05, x("a") + 0.2 - k_touching_m) << "tick " << tick << ", lane " << lane;
        EXPECT_GE(x("p") - 0.05, x("c") + 3.05 - k_touching_m) << "tick " << tick << ", lane " << lane;
        EXPECT_GE(x("b") - 0.2, x("p") + 0.05 - k_touching_m) << "tick " << tick << ", lane " << lane;
        for (const char* name : {"a", "c", "p", "b"}) places.push_back(x(name));
      }
    }
    if (!first) first = places;
    EXPECT_EQ(places, *first) << threads << " threads, tiles of " << tile_m << " m";
  }
}

// Its front turns the robot's corner past the puck's side: half a turn pushes it out of the circle of the
// corner.
TEST_F(Pushing, ATurningRobotPushesSideways) {
  Simulation simulation = world({{"r", "robot", 0}, {"p", "puck", 0.27, 0.18}});
  drive(simulation, "r", 0, 40, -0.5);
  const Pose robot = simulation.find("r").pose();
  const Pose puck = simulation.find("p").pose();
  EXPECT_NEAR(robot.heading, -2, 1e-9) << "nothing held it";
  EXPECT_EQ(puck.heading, 0);
  EXPECT_GE(std::max(std::abs(puck.x), std::abs(puck.y)), 0.2);
}

TEST_F(Pushing, AChainIsAsLongAsTheRobotIsStrong) {
  // Two in a row, touching: they go on together, 0.1 m apart.
  Simulation two = world({{"r", "weak", 0}, {"p", "puck", 0.25}, {"q", "puck", 0.35}});
  drive(two, "r", 0.2, 20);
  EXPECT_NEAR(two.find("r").pose().x, 0.4, 1e-9);
  EXPECT_NEAR(two.find("p").pose().x, 0.65, 1e-6);
  EXPECT_NEAR(two.find("q").pose().x, 0.75, 1e-6);
  // A third is too much, and nothing moves.
  Simulation three = world({{"r", "weak", 0}, {"p", "puck", 0.25}, {"q", "puck", 0.35}, {"s", "puck", 0.45}});
  drive(three, "r", 0.2, 20);
  EXPECT_EQ(three.find("r").pose().x, 0);
  EXPECT_EQ(three.find("p").pose().x, 0.25);
  EXPECT_TRUE(three.find("r").stalled());
  // A gap of 0.105 m before the third: five ticks of 0.02 m.
  Simulation gap = world({{"r", "weak", 0}, {"p", "puck", 0.25}, {"q", "puck", 0.35}, {"s", "puck", 0.555}});
  drive(gap, "r", 0.2, 20);
  EXPECT_NEAR(gap.find("r").pose().x, 0.1, 1e-9);
  EXPECT_EQ(gap.find("s").pose().x, 0.555);
}

// The wall's near face is at 0.99 m: the puck's centre comes to 0.94 m at most, the robot's to 0.69 m.
TEST_F(Pushing, APuckAtAWallStopsTheRobot) {
  for (const double speed : {0.1, 0.3, 0.9}) {
    Simulation simulation = world({{"r", "robot", 0}, {"p", "puck", 0.4}, {"w", "wall", 1}});
    drive(simulation, "r", speed, 100);
    EXPECT_LE(simulation.find("p").pose().x, 0.94 + 1e-9);
    EXPECT_GT(simulation.find("p").pose().x, 0.94 - speed / 10);
    EXPECT_NEAR(simulation.find("p").pose().x - simulation.find("r").pose().x, 0.25, 1e-6);
    EXPECT_TRUE(simulation.find("r").stalled());
  }
}

// Of two that press on one puck from opposite sides neither goes on; side by side both do.
TEST_F(Pushing, TwoRobotsAndOnePuck) {
  Simulation against = world({{"a", "robot", -0.35}, {"b", "robot", 0.35, 0, 180}, {"p", "puck", 0}});
  against.find("b").set_speed(0.2, 0, 0);
  drive(against, "a", 0.2, 30);
  const double left = against.find("a").pose().x;
  const double right = against.find("b").pose().x;
  EXPECT_LT(std::abs(right - left - 0.5), 0.021) << "the puck is between them";
  EXPECT_TRUE(against.find("a").stalled() && against.find("b").stalled());

  Simulation beside = world({{"a", "robot", 0, -0.15}, {"b", "robot", 0, 0.15}, {"p", "puck", 0.25, 0}});
  beside.find("b").set_speed(0.2, 0, 0);
  drive(beside, "a", 0.2, 30);
  EXPECT_NEAR(beside.find("a").pose().x, 0.6, 1e-9);
  EXPECT_NEAR(beside.find("b").pose().x, 0.6, 1e-9);
  EXPECT_NEAR(beside.find("p").pose().x, 0.85, 1e-6);
}

TEST_F(Pushing, WhatIsNotPushableStops) {
  Simulation grippable = world({{"r", "robot", 0}, {"p", "grippable", 0.26}, {"q", "puck", 3}});
  drive(grippable, "r", 0.2, 5);
  EXPECT_EQ(grippable.find("r").pose().x, 0);
  Simulation robot = world({{"r", "robot", 0}, {"p", "puck", 0.25}, {"other", "robot", 0.5}});
  drive(robot, "r", 0.2, 5);
  EXPECT_EQ(robot.find("r").pose().x, 0) << "a robot behind the puck";
  Simulation weakling = world({{"r", "blocked", 0}, {"p", "puck", 0.26}});
  drive(weakling, "r", 0.2, 5);
  EXPECT_EQ(weakling.find("r").pose().x, 0);
}

// A tick takes the robot as far as the puck is wide. It is not jumped over: it goes before the robot, slips
// aside where only its corner is met, or nothing moves.
TEST_F(Pushing, NothingIsJumpedOver) {
  for (int i = 0; i < 20; ++i) {
    Simulation simulation =
        world({{"r", "robot", 0, 0.01 * i, 0}, {"p", "puck", 0.5 + 0.02 * i}, {"w", "wall", 3}});
    simulation.find("r").set_speed(1, 0, 0);
    for (int tick = 0; tick < 40; ++tick) {
      simulation.step();
      const Pose robot = simulation.find("r").pose();
      const Pose puck = simulation.find("p").pose();
      ASSERT_TRUE(puck.x - robot.x >= 0.25 - 1e-9 || robot.y - puck.y >= 0.2 - 1e-9)
          << i << ", tick " << tick;
      ASSERT_TRUE(i > 17 || puck.x > robot.x + 0.25 - 1e-9) << i;
      ASSERT_LE(simulation.find("p").pose().x, 2.94 + 1e-9);
    }
  }
}

// The smallest width of pushable bodies decides at how many poses a motion is tested. The shape of a body
// that is unborn is empty and has no width, so that of its type counts.
TEST_F(Pushing, AnUnbornBodyCountsLikeOneThatIsFarAway) {
  constexpr std::string_view k_reserve = R"(
  "populations": [{"name": "spare", "type": "hand", "count": 0, "reserve": 1,
    "place": {"rule": "grid", "region_m": [[8, 8], [9, 9]], "pitch_m": 0.5}}],
  "at": [{"time_s": 1000, "add": {"population": "spare", "count": 1, "pose": {"x_m": 9}}}],)";
  const auto pushed = [](Simulation simulation) {
    drive(simulation, "r", 0.3, 30, 0.1);
    const Pose puck = simulation.find("p").pose();
    EXPECT_GT(puck.x, 0.8) << "the puck is pushed";
    return std::tuple(puck.x, puck.y, puck.heading);
  };
  EXPECT_EQ(pushed(world({{"r", "robot", 0}, {"p", "puck", 0.5, 0.04, 20}}, k_reserve)),
            pushed(world({{"r", "robot", 0}, {"p", "puck", 0.5, 0.04, 20}, {"h", "hand", 9}})));
}

TEST_F(Pushing, WhatDrivesIsNotPushed) {
  const auto file = write("driven.json",
                          R"({"troupe": 1,
 "types": {"r": {"size_m": [0.4, 0.3, 0.3], "pushable": true, "drive": {"kind": "diff"}}},
 "models": [{"name": "r", "type": "r"}]})");
  EXPECT_THAT(test::message_of<InputError>([&] { Simulation simulation(file); }),
              HasSubstr("driven.json:2: error: type \"r\" has a drive and is pushable"));
}

TEST(ClusteringScene, RobotsPushPucksTogether) {
  if (test::k_slow_build) GTEST_SKIP() << "takes too long";
  Simulation simulation(test::source_dir() / "worlds" / "clustering.json");
  Measures measures(simulation, {R"({"kind": "clusters", "distance_m": 0.08})"});
  EXPECT_EQ(measures.value("clusters"), 81);
  simulation.run_for(1800);
  EXPECT_LT(measures.value("clusters"), 35);
}

}  // namespace
}  // namespace troupe::pushing_test
