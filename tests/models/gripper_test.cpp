#include "models/devices/gripper.hpp"

#include "engine/observing/frame.hpp"
#include "engine/world/world.hpp"
#include "tests/support/devices.hpp"
#include "tests/support/message_of.hpp"
#include "troupe/frame_data.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace troupe::models::gripper_test {
namespace {

using engine::World;
using test::box;
using test::leg;
using test::order;
using test::SceneBuilder;

constexpr double k_near = 1e-9;  // m: rounding

// A robot of 0.4 m with the default gripper in front of it: base from 0.2 to 0.268 m, paddles from there to
// 0.4 m, their inner faces 0.12 m to either side.
constexpr double k_grasp_m = 0.34;  // ahead of the robot's origin: between the paddles

TypeId gripper_robot(SceneBuilder& scene, const std::string& name, std::vector<engine::Record> orders,
                     std::vector<engine::Record> legs = {},
                     std::initializer_list<std::pair<std::string_view, engine::Value>> values = {}) {
  const TypeId type = scene.robot(name, {box(0.4, 0.4, 0.3)});
  test::add_device(scene[type], "hand", "gripper", {0.3, 0, 0, 0}, values);
  if (!legs.empty()) scene[type].controllers.push_back(test::drive_legs(std::move(legs)));
  if (!orders.empty()) scene[type].controllers.push_back(test::operate(std::move(orders)));
  return type;
}

TypeId puck(SceneBuilder& scene, double size = 0.1) {
  return scene.type("puck" + std::to_string(scene.spec.types.size()), {box(size, size, 0.1)},
                    {.gripper = true});
}

void step(World& world, std::size_t ticks) {
  for (std::size_t t = 0; t < ticks; ++t) world.step();
}

const GripperState& hand(const World& world, BodyId robot) {
  return test::state_of<GripperState>(world, robot, 0);
}

TEST(Gripper, CarriesAPuckToWhereItLetsGo) {
  SceneBuilder scene;
  const BodyId robot = scene.body("r", gripper_robot(scene, "robot",
                                                     {order(0.1, "hand", "close"), order(2, "hand", "up"),
                                                      order(6, "hand", "down"), order(9, "hand", "open")},
                                                     {leg(4, 0), leg(6, 0.5)}));
  const BodyId object = scene.body("o", puck(scene), {k_grasp_m, 0.01, 0, 0.2});
  World world = scene.world();
  step(world, 2);
  EXPECT_EQ(hand(world, robot).paddles, GripperState::closing);
  EXPECT_EQ(hand(world, robot).beam_inner, 1);
  EXPECT_FALSE(world.view().carrier(world.view().row(object)));
  step(world, 18);
  ASSERT_EQ(world.view().carrier(world.view().row(object)), robot);
  EXPECT_EQ(hand(world, robot).paddles, GripperState::closed);
  EXPECT_EQ(hand(world, robot).held, object.value + 1);
  EXPECT_NEAR(world.view().pose(object).x, k_grasp_m, 1e-12) << "taking it does not move it";
  EXPECT_GT(hand(world, robot).paddle_position, 0.3);
  EXPECT_LT(hand(world, robot).paddle_position, 0.6) << "stopped at a puck of 0.1 m";

  step(world, 20);  // t = 4 s: up
  EXPECT_EQ(hand(world, robot).lift, GripperState::is_up);
  EXPECT_NEAR(world.view().pose(object).z, 0.6 * 0.2, k_near);
  step(world, 60);  // t = 10 s: a metre on, down, open
  EXPECT_NEAR(world.view().pose(robot).x, 1, k_near);
  EXPECT_FALSE(world.view().carrier(world.view().row(object)));
  EXPECT_NEAR(world.view().pose(object).x, 1 + k_grasp_m, k_near);
  EXPECT_NEAR(world.view().pose(object).y, 0.01, k_near);
  EXPECT_NEAR(world.view().pose(object).z, 0, k_near);
  EXPECT_NEAR(world.view().pose(object).heading, 0.2, k_near);
  step(world, 20);
  EXPECT_EQ(hand(world, robot).paddles, GripperState::is_open);
  EXPECT_EQ(hand(world, robot).paddle_position, 0);
  EXPECT_EQ(hand(world, robot).held, 0u);
}

TEST(Gripper, PaddlesMoveEndToEndInTwoSeconds) {
  SceneBuilder scene;
  const BodyId robot = scene.body("r", gripper_robot(scene, "robot", {order(0.1, "hand", "close")}));
  World world = scene.world();
  step(world, 11);
  EXPECT_NEAR(hand(world, robot).paddle_position, 0.5, k_near);
  // Two more solids than the robot's own: the right paddle's inner face is at y = -0.06.
  double highest = -1;
  for (const Vec2& v : world.view().outline(world.view().row(robot)).last(4))
    highest = std::max(highest, v.y());
  EXPECT_NEAR(highest, -0.06, k_near);
  step(world, 11);
  EXPECT_EQ(hand(world, robot).paddles, GripperState::closed);
  EXPECT_EQ(hand(world, robot).paddle_position, 1);
}

TEST(Gripper, PaddlesStopAtWhatCannotBeGripped) {
  SceneBuilder scene;
  const BodyId robot = scene.body("r", gripper_robot(scene, "robot", {order(0.1, "hand", "close")}));
  scene.wall(k_grasp_m - 0.02, -0.032, k_grasp_m + 0.02, 0.032);
  World world = scene.world();
  step(world, 30);
  EXPECT_EQ(hand(world, robot).paddles, GripperState::closing);
  EXPECT_EQ(hand(world, robot).stalled, 1);
  EXPECT_NEAR(hand(world, robot).paddle_position, 0.7, k_near) << "faces 0.036 m to either side";
}

TEST(Gripper, WhatIsTooWideIsNotHeld) {
  SceneBuilder scene;
  // Tips of 0.2 m reach between the paddles, but it is 0.4 m wide behind them.
  const TypeId wide =
      scene.type("wide", {box(0.1, 0.2, 0.1), Solid{{test::rectangle(0.06, -0.2, 0.3, 0.2)}, {0, 0.1}}},
                 {.gripper = true});
  const BodyId robot = scene.body("r", gripper_robot(scene, "robot", {order(0.1, "hand", "close")}));
  const BodyId object = scene.body("o", wide, {k_grasp_m + 0.005, 0, 0, 0});
  World world = scene.world();
  step(world, 30);
  EXPECT_EQ(hand(world, robot).contact_left, 1);
  EXPECT_FALSE(world.view().carrier(world.view().row(object)));
}

/// A convex outline keeps all its corners, more than a placed shape stores.
TEST(Gripper, HoldsAPuckOfManyCorners) {
  SceneBuilder scene;
  Ring ring;
  for (int k = 0; k < 200; ++k)
    ring.emplace_back(0.05 * std::cos(2 * k_pi * k / 200), 0.05 * std::sin(2 * k_pi * k / 200));
  const TypeId round = scene.type("round", {Solid{{ring}, {0, 0.1}}}, {.gripper = true});
  const BodyId robot = scene.body("r", gripper_robot(scene, "robot", {order(0.1, "hand", "close")}));
  const BodyId object = scene.body("o", round, {k_grasp_m, 0, 0, 0});
  World world = scene.world();
  step(world, 30);
  EXPECT_EQ(world.view().carrier(world.view().row(object)), robot);
}

TEST(Gripper, ClosedPaddlesTouchNothingBesideThem) {
  SceneBuilder scene;
  const BodyId robot = scene.body("r", gripper_robot(scene, "robot", {}, {}, {{"paddles", "closed"}}));
  scene.body("o", puck(scene, 0.08), {k_grasp_m, 0.1, 0, k_pi / 4});
  World world = scene.world();
  step(world, 2);
  EXPECT_EQ(hand(world, robot).paddle_position, 1);
  EXPECT_EQ(hand(world, robot).contact_left, 0);
  EXPECT_EQ(hand(world, robot).contact_right, 0);
}

/// A post out of reach with an arm that can be gripped: the arm is between the paddles only while it is out.
TEST(Gripper, GripsAnArmWhereItIsNow) {
  for (const double out : {0.0, 0.3}) {
    SceneBuilder scene;
    const TypeId post = scene.type("post", {box(0.2, 0.2, 0.1)});
    test::add_arm(scene[post], "arm", {0.15, 0, 0, 0}, {box(0.1, 0.1, 0.1)}, {{"start_position", out}});
    scene[post].parts.back().returns.gripper = true;
    const BodyId robot = scene.body("r", gripper_robot(scene, "robot", {order(0.1, "hand", "close")}));
    const BodyId far = scene.body("far", post, {k_grasp_m + 0.45, 0, 0, k_pi});
    World world = scene.world();
    step(world, 2);
    EXPECT_EQ(hand(world, robot).beam_inner, out > 0);
    step(world, 30);
    EXPECT_EQ(world.view().carrier(world.view().row(far)).has_value(), out > 0)
        << "the arm is out by " << out;
    EXPECT_EQ(hand(world, robot).paddles, GripperState::closed);
  }
}

TEST(Gripper, DoesNotGripALiftAboveIt) {
  SceneBuilder scene;
  const TypeId post = scene.type("post", {box(0.2, 0.2, 1)});
  test::add_arm(scene[post], "lift", {0.15, 0, 0, 0}, {box(0.1, 0.1, 0.1)},
                {{"axis", std::vector<double>{0, 0, 1}}, {"start_position", 0.5}});
  scene[post].parts.back().returns.gripper = true;
  const BodyId robot = scene.body("r", gripper_robot(scene, "robot", {order(0.1, "hand", "close")}));
  const BodyId above = scene.body("o", post, {k_grasp_m + 0.175, 0, 0, k_pi});
  World world = scene.world();
  step(world, 30);
  EXPECT_FALSE(world.view().carrier(world.view().row(above)));
  EXPECT_EQ(hand(world, robot).paddle_position, 1);
}

TEST(Gripper, AutosnatchNeedsNoOrders) {
  SceneBuilder scene;
  const BodyId robot =
      scene.body("r", gripper_robot(scene, "robot", {}, {leg(1, 0.5)}, {{"autosnatch", true}}));
  const BodyId object = scene.body("o", puck(scene), {k_grasp_m + 0.5, 0, 0, 0});
  World world = scene.world();
  step(world, 40);
  ASSERT_EQ(world.view().carrier(world.view().row(object)), robot);
  EXPECT_EQ(hand(world, robot).paddles, GripperState::closed);
}

TEST(Gripper, OfTwoThatCloseOnOneTheLowestIdHasIt) {
  SceneBuilder scene;
  const TypeId type = gripper_robot(scene, "robot", {order(0.1, "hand", "close")});
  const TypeId bar = scene.type("bar", {box(0.3, 0.1, 0.1)}, {.gripper = true});
  const BodyId second_in_space = scene.body("a", type, {1, 0, 0, k_pi});
  const BodyId other = scene.body("b", type, {0, 0, 0, 0});
  const BodyId object = scene.body("o", bar, {0.5, 0, 0, 0});
  World world = scene.world();
  step(world, 20);
  EXPECT_EQ(world.view().carrier(world.view().row(object)), second_in_space);
  EXPECT_EQ(hand(world, other).taken, 1);
  EXPECT_EQ(hand(world, other).held, 0u);
}

/// Four that close on one pillar: two from either side, one on the floor and one above it.
struct Contested {
  std::vector<BodyId> robots;  // the first and the third are on one side
  BodyId pillar;

  Contested(SceneBuilder& scene, TypeId robot, TypeId object, const Vec2& at, int turned) {
    for (int i = 0; i < 4; ++i) {
      const int place = (i + turned) % 4;
      const Pose facing{at.x(), at.y(), place / 2 == 0 ? 0.0 : 0.35, place % 2 == 0 ? 0.0 : k_pi};
      const Pose pose = compose(facing, {-0.46, 0, 0, 0});
      robots.push_back(scene.body(name('r', scene), robot, pose));
    }
    pillar = scene.body(name('o', scene), object, {at.x(), at.y(), 0, 0});
  }
  static std::string name(char first, const SceneBuilder& scene) {
    return std::string(1, first).append(std::to_string(scene.spec.bodies.size()));
  }
};

TEST(Gripper, OfManyThatCloseOnOneTheLowestIdHasItAndTakesItAway) {
  SceneBuilder scene;
  const TypeId robot =
      gripper_robot(scene, "robot", {order(0.1, "hand", "close")}, {leg(1.5, 0), leg(4, -0.4)});
  const TypeId object = scene.type("pillar", {box(0.2, 0.2, 0.6)}, {.gripper = true});
  std::vector<Contested> contests;
  for (int i = 0; i < 4; ++i) contests.emplace_back(scene, robot, object, Vec2(4.0 * i, 0.3 * i), i);
  std::vector<std::uint64_t> expected;
  for (const engine::WorldOptions& options :
       {engine::WorldOptions{1, 0}, {2, 0}, {8, 0}, {2, 0.7}, {3, 5.3}}) {
    World world = scene.world(options);
    std::vector<std::uint64_t> hashes;
    for (int t = 0; t < 15; ++t) {
      world.step();
      hashes.push_back(world.hashes().state);
    }
    EXPECT_EQ(world.view().counts().carried, contests.size());
    for (const Contested& contest : contests) {
      EXPECT_EQ(world.view().carrier(world.view().row(contest.pillar)), contest.robots.front());
      EXPECT_EQ(hand(world, contest.robots.front()).taken, 0);
      for (std::size_t i = 1; i < 4; ++i) {
        EXPECT_EQ(hand(world, contest.robots[i]).taken, 1);
        EXPECT_EQ(hand(world, contest.robots[i]).held, 0u);
      }
    }
    for (int t = 0; t < 45; ++t) {
      world.step();
      hashes.push_back(world.hashes().state);
    }
    for (const Contested& contest : contests) {  // 2.5 s backwards at 0.4 m/s
      const Pose from = scene.spec.bodies[contest.robots.front().index()].pose_world_body;
      const Pose to = compose(from, {0.46 - 1, 0, 0, 0});
      EXPECT_NEAR(world.view().pose(contest.pillar).x, to.x, k_near);
      EXPECT_NEAR(world.view().pose(contest.pillar).y, to.y, k_near);
      for (const std::size_t across : {1u, 3u})
        EXPECT_EQ(hand(world, contest.robots[across]).paddles, GripperState::closed) << "on nothing";
    }
    if (expected.empty()) expected = hashes;
    EXPECT_EQ(hashes, expected);
  }
}

/// A robot that holds a puck is held itself: all go where the last one goes.
TEST(Gripper, ChainsMoveAsOne) {
  SceneBuilder scene;
  const TypeId big = gripper_robot(scene, "big", {order(3, "hand", "close")}, {leg(6, 0), leg(8, 0.3, 0.4)});
  const TypeId small = scene.robot("small", {box(0.2, 0.2, 0.1)});
  scene[small].parts[0].returns.gripper = true;
  test::add_device(scene[small], "hand", "gripper", {0.15, 0, 0, 0},
                   {{"size", std::vector<double>{0.1, 0.15, 0.1}}});
  scene[small].controllers.push_back(test::operate({order(0.1, "hand", "close")}));
  const BodyId carrier = scene.body("big", big);
  const BodyId middle = scene.body("small", small, {0.373, 0, 0, 0});
  const BodyId object = scene.body("o", puck(scene, 0.05), {0.373 + 0.167, 0, 0, 0});
  World world = scene.world();
  step(world, 60);
  ASSERT_EQ(world.view().carrier(world.view().row(object)), middle);
  ASSERT_EQ(world.view().carrier(world.view().row(middle)), carrier);
  EXPECT_TRUE(world.view().same_tree(world.view().row(object), world.view().row(carrier)));
  step(world, 20);
  const Pose root = world.view().pose(carrier);
  EXPECT_GT(root.x, 0.4);
  EXPECT_NEAR(root.heading, 0.8, k_near);
  const Pose expected = compose(root, {0.373 + 0.167, 0, 0, 0});
  EXPECT_NEAR(world.view().pose(object).x, expected.x, k_near);
  EXPECT_NEAR(world.view().pose(object).y, expected.y, k_near);
  EXPECT_NEAR(world.view().pose(object).heading, expected.heading, k_near);
}

/// What is carried is in the way of others, and others are in its way.
TEST(Gripper, CargoStopsItsCarrierAtAWall) {
  SceneBuilder scene;
  const BodyId robot = scene.body(
      "r", gripper_robot(scene, "robot", {order(0.1, "hand", "close")}, {leg(3, 0), leg(10, 0.5)}));
  const TypeId bar = scene.type("bar", {box(0.5, 0.1, 0.1)}, {.gripper = true});
  const BodyId object = scene.body("o", bar, {k_grasp_m + 0.18, 0, 0, 0});
  scene.wall(1, -1, 1.1, 1);
  World world = scene.world();
  step(world, 60);
  ASSERT_EQ(world.view().carrier(world.view().row(object)), robot);
  EXPECT_TRUE(world.view().stalled(world.view().row(robot)));
  EXPECT_LE(world.view().pose(object).x + 0.25, 1 + k_near);
  EXPECT_GT(world.view().pose(object).x + 0.25, 1 - 0.051)
      << "the bar, not the robot, is what meets the wall";
}

TEST(Gripper, ItsOwnRangerDoesNotSeeWhatItHolds) {
  SceneBuilder scene;
  const TypeId type = gripper_robot(scene, "robot", {order(0.1, "hand", "close")});
  scene[type].devices.push_back(test::ranger("eye", {{.pose = {0, 0, 0.05, 0}}}));
  const BodyId robot = scene.body("r", type);
  scene.body("o", puck(scene), {k_grasp_m, 0, 0, 0});
  for (const auto ranging : {engine::RangingEngine::exact, engine::RangingEngine::grid}) {
    scene.spec.ranging = ranging;
    World world = scene.world();
    const auto range = [&] {
      const Row row = world.view().row(robot);
      return world.tables()[world.view().type(row).devices[1].table].cell<float>(world.view().slot(row),
                                                                                 0)[0];
    };
    step(world, 1);
    EXPECT_NEAR(range(), k_grasp_m - 0.05, 0.03);
    step(world, 20);
    EXPECT_EQ(range(), 5) << "nothing else is there";
  }
}

/// Number of lines from grippers to the bodies that they hold, in a picture of the world.
std::size_t count_holds(const World& world) {
  engine::Frame frame = engine::make_frame(world);
  add_layer(world, engine::FrameLayer::grips, frame);
  return static_cast<std::size_t>(
      std::ranges::count(frame.grips, engine::FrameTie::Kind::holds, &engine::FrameTie::kind));
}

TEST(Gripper, NoLineIsDrawnToABodyThatDiedWhileTheRobotIsDisabled) {
  SceneBuilder scene;
  scene.spec.mortal = true;
  const BodyId robot = scene.body("r", gripper_robot(scene, "robot", {order(0.1, "hand", "close")}));
  const BodyId object = scene.body("o", puck(scene), {k_grasp_m, 0, 0, 0});
  World world = scene.world();
  step(world, 20);
  ASSERT_EQ(world.view().carrier(world.view().row(object)), robot);
  EXPECT_EQ(count_holds(world), 1u);
  world.set_disabled(world.view().row(robot), true);
  world.remove(world.view().row(object));
  step(world, 3);
  EXPECT_NE(hand(world, robot).held, 0u) << "a gripper that does not run keeps its state";
  EXPECT_EQ(count_holds(world), 0u);
  world.set_disabled(world.view().row(robot), false);
  step(world, 1);
  EXPECT_EQ(hand(world, robot).held, 0u);
}

TEST(Gripper, ClosesOnWhenTheHeldBodyHasDied) {
  SceneBuilder scene;
  scene.spec.mortal = true;
  const BodyId robot =
      scene.body("r", gripper_robot(scene, "robot", {order(0.1, "hand", "close"), order(4, "hand", "open")}));
  const BodyId object = scene.body("o", puck(scene), {k_grasp_m, 0, 0, 0});
  World world = scene.world();
  step(world, 20);
  ASSERT_EQ(world.view().carrier(world.view().row(object)), robot);
  EXPECT_EQ(hand(world, robot).paddles, GripperState::closed);
  world.remove(world.view().row(object));
  step(world, 1);
  EXPECT_EQ(hand(world, robot).held, 0u);
  EXPECT_EQ(hand(world, robot).paddles, GripperState::closing) << "the command still holds";
  step(world, 15);
  EXPECT_EQ(hand(world, robot).paddles, GripperState::closed);
  EXPECT_EQ(hand(world, robot).paddle_position, 1);
}

TEST(Gripper, PaddlesMustFitSideBySide) {
  const auto build = [](double y) {
    SceneBuilder scene;
    scene.body("r",
               gripper_robot(scene, "robot", {}, {}, {{"paddle_size", std::vector<double>{0.6, y, 0.4}}}));
    Diagnostics diagnostics;
    World(scene.spec, test::registry(), {}, diagnostics);
  };
  EXPECT_NO_THROW(build(0.499));
  EXPECT_EQ(test::message_of<InputError>([&] { build(0.5); }),
            "error: device \"hand\" has a paddle_size of [0.6, 0.5, 0.4], whose y must be below 0.5, or two "
            "paddles do not fit");
}

/// The same bits whatever the threads and tiles: carriers cross the borders of tiles, and compete.
TEST(Gripper, CarriesTheSameOnAnyThreadsAndTiles) {
  SceneBuilder scene;
  const TypeId type = gripper_robot(
      scene, "robot", {order(0.5, "hand", "close"), order(3, "hand", "up"), order(5, "hand", "open")},
      {leg(0.4, 0.3), leg(3, 0, 0.1), leg(8, 0.5, 0.3)});
  const TypeId object = puck(scene, 0.08);
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 4; ++j) {
      const double x = 1.0 * i;
      const double y = 0.7 * j;
      scene.body("r" + std::to_string(4 * i + j), type, {x, y, 0, 0.3 * (i - j)});
      const Pose at = compose({x, y, 0, 0.3 * (i - j)}, {k_grasp_m + 0.09, 0.02 * (j - 1), 0, 0});
      scene.body("o" + std::to_string(4 * i + j), object, at);
    }
  std::vector<std::uint64_t> expected;
  std::size_t most_carried = 0;
  for (const engine::WorldOptions& options :
       {engine::WorldOptions{1, 0}, {2, 0}, {8, 0}, {2, 0.7}, {3, 5.3}}) {
    World world = scene.world(options);
    std::vector<std::uint64_t> hashes;
    for (int t = 0; t < 70; ++t) {
      world.step();
      hashes.push_back(world.hashes().state);
      most_carried = std::max(most_carried, world.view().counts().carried);
    }
    if (expected.empty()) expected = hashes;
    EXPECT_EQ(hashes, expected);
  }
  EXPECT_GE(most_carried, 5u);
}

}  // namespace
}  // namespace troupe::models::gripper_test
