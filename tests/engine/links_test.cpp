// Joints and cargo: moving joints and carried bodies never overlap other bodies, and the results do not
// depend on threads, tiles or the order of rows.

#include "base/random.hpp"
#include "engine/world/world.hpp"
#include "models/drives/wheels.hpp"
#include "tests/support/access_of.hpp"
#include "tests/support/devices.hpp"
#include "tests/support/slow_build.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <vector>

namespace troupe::engine::links_test {
namespace {

using test::box;
using test::order;
using test::SceneBuilder;

/// A convex block in the world's frame.
struct Block {
  BodyId tree;
  Ring ring;
  ZInterval z;
};

/// By how much two convex rings overlap, at least: the smallest depth along the normal of any edge, m.
double depth(const Ring& a, const Ring& b) {
  double least = 1e300;
  for (const Ring* ring : {&a, &b})
    for (std::size_t i = 0; i < ring->size(); ++i) {
      const Vec2 edge = (*ring)[(i + 1) % ring->size()] - (*ring)[i];
      const Vec2 normal = Vec2(edge.y(), -edge.x()) / std::hypot(edge.x(), edge.y());
      double high = -1e300, low = 1e300;  // of the ring itself, and of the other
      for (const Vec2& v : *ring) high = std::max(high, normal.dot(v));
      for (const Vec2& v : ring == &a ? b : a) low = std::min(low, normal.dot(v));
      least = std::min(least, high - low);
    }
  return least;
}

/// What a joint's pose q, in the frame `rest`, makes of a point: by the book.
Vec2 moved(const Pose& rest, const Pose& q, const Vec2& p) {
  const auto turn = [](double a, const Vec2& v) {
    return Vec2(v.x() * std::cos(a) - v.y() * std::sin(a), v.x() * std::sin(a) + v.y() * std::cos(a));
  };
  const Vec2 in_joint = turn(-rest.heading, p - rest.position());
  return rest.position() + turn(rest.heading, q.position() + turn(q.heading, in_joint));
}

/// Every obstacle of the world, from nothing but poses and the poses of joints. Joints stand on bodies here.
/// bodies: how many are looked at, with the ground.
std::vector<Block> blocks_of(const World& world, std::size_t bodies) {
  std::vector<Block> blocks;
  const WorldSpec& spec = world.spec();
  for (std::size_t b = 1; b < std::min(bodies, spec.bodies.size()); ++b) {
    const BodyId body(b);
    const Row row = world.view().row(body);
    BodyId tree = body;
    while (row.valid() && world.view().carrier(world.view().row(tree)))
      tree = *world.view().carrier(world.view().row(tree));
    const Pose pose = world.view().pose(body);
    const TypeSpec& type = spec.type(BodyId(b));
    for (const PartSpec& part : type.parts)
      for (const Solid& solid : part.solids) {
        Block block{tree, {}, solid.z.shifted(pose.z)};
        for (Vec2 p : solid.contours[0]) {
          if (part.joint != k_rigid)
            p = moved(type.joints[static_cast<std::size_t>(part.joint)].pose_body_joint,
                      world.state().joint_state(row, static_cast<std::size_t>(part.joint)), p);
          block.ring.push_back(moved({}, pose, p));
        }
        if (part.joint != k_rigid)
          block.z = block.z.shifted(world.state().joint_state(row, static_cast<std::size_t>(part.joint)).z);
        blocks.push_back(std::move(block));
      }
  }
  return blocks;
}

/// The deepest overlap of blocks of different trees, m; 0 or less: none.
double deepest(const World& world, std::size_t bodies = 1000) {
  const std::vector<Block> blocks = blocks_of(world, bodies);
  double most = -1;
  for (std::size_t i = 0; i < blocks.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (blocks[i].tree != blocks[j].tree && blocks[i].z.overlaps(blocks[j].z))
        most = std::max(most, depth(blocks[i].ring, blocks[j].ring));
  return most;
}

/// Machines with arms that swing and slides that reach, crowded so that they are always in one another's way.
SceneBuilder machines(std::uint64_t seed) {
  SceneBuilder scene;
  scene.spec.seed = seed;
  for (std::uint32_t i = 0; i < 9; ++i) {
    const std::uint32_t column = i / 3;
    Random random(seed, 7, i, 0);
    const std::string name = fmt::format("m{}", i);
    const TypeId type = scene.robot(name, {box(0.3, 0.3, 0.3)});
    test::add_arm(
        scene[type], "arm", {0, 0, 0.3, 0}, {Solid{{test::rectangle(0, -0.03, 0.55, 0.03)}, {0, 0.1}}},
        {{"type", "rotational"}, {"min_position", -100.0}, {"max_position", 100.0}, {"max_speed", 6.0}});
    test::add_arm(scene[type], "slide", {0.15, 0, 0.1, 0},
                  {Solid{{test::rectangle(0, -0.05, 0.1, 0.05)}, {0, 0.3}}},
                  {{"max_position", 0.4}, {"max_speed", 2.0}});
    std::vector<Record> orders;
    for (int t = 0; t < 12; ++t) {
      orders.push_back(order(0.1 + 0.4 * t, "arm", "speed", random.uniform(-6, 6)));
      orders.push_back(order(0.1 + 0.5 * t, "slide", "speed", random.uniform(-2, 2)));
    }
    scene[type].controllers.push_back(test::operate(orders));
    scene[type].controllers.push_back(test::drive_legs(
        {test::leg(2, random.uniform(-0.5, 0.5), 1), test::leg(9, random.uniform(-0.5, 0.5), -0.7)}));
    scene.body(name, type, {0.9 * (i % 3), 0.9 * column, 0, random.uniform(-0.2, 0.2)});
  }
  scene.wall(-0.8, -0.8, 2.6, -0.7);
  scene.wall(2.5, -0.7, 2.6, 2.6);
  return scene;
}

TEST(Links, NothingOverlapsWhateverMoves) {
  std::size_t stalls = 0;
  std::size_t moves = 0;
  for (std::uint64_t seed = 1; seed <= (test::k_slow_build ? 2u : 12u); ++seed) {
    World world = machines(seed).world();
    ASSERT_LT(deepest(world), 1e-9);
    for (int t = 0; t < 60; ++t) {
      world.step();
      ASSERT_LT(deepest(world), 1e-9) << "seed " << seed << ", tick " << world.tick();
      for (std::uint32_t b = 1; b < 10; ++b)
        for (const std::size_t d : {0u, 1u}) {
          const auto& state = test::state_of<models::ActuatorState>(world, BodyId(b), d);
          stalls += state.stalled;
          moves += state.velocity != 0;
        }
    }
  }
  EXPECT_GT(stalls, 100u) << "they are in one another's way";
  EXPECT_GT(moves, 2 * stalls) << "and still move";
}

/// Robots that close on pucks, lift them and drive them into one another.
SceneBuilder carriers(std::uint64_t seed) {
  SceneBuilder scene;
  scene.spec.seed = seed;
  Random random(seed, 8, 0, 0);
  const auto draw = [&](double most) { return random.uniform(-most, most); };
  for (int i = 0; i < 9; ++i) {
    const int column = i / 3;
    const std::string name = fmt::format("c{}", i);
    const TypeId type = scene.robot(name, {box(0.3, 0.3, 0.3)});
    test::add_device(scene[type], "hand", "gripper", {0.25, 0, 0, 0});
    constexpr std::string_view k_orders[] = {"open", "close", "up", "down"};
    std::vector<Record> orders{order(0.1, "hand", "close")};
    for (int t = 1; t < 8; ++t)
      orders.push_back(order(1.5 * t, "hand", std::string(k_orders[random.below(4)])));
    scene[type].controllers.push_back(test::operate(std::move(orders)));
    scene[type].controllers.push_back(test::drive_legs(
        {test::leg(1, 0), test::leg(4, draw(0.4), draw(0.8)), test::leg(9, draw(0.4), draw(0.8))}));
    const Pose at{0.9 * (i % 3), 0.9 * column, 0, draw(0.2)};
    scene.body(name, type, at);
    const double size = random.uniform(0.06, 0.18);
    const TypeId puck = scene.type("puck of " + name, {box(size, 0.1, 0.1)}, {.gripper = true});
    scene.body(fmt::format("p{}", i), puck, compose(at, {0.245 + size / 2, draw(0.03), 0, 0}));
  }
  return scene;
}

TEST(Links, NothingOverlapsWhateverIsCarried) {
  std::size_t most_carried = 0;
  for (std::uint64_t seed = 1; seed <= (test::k_slow_build ? 1u : 6u); ++seed) {
    World world = carriers(seed).world();
    ASSERT_LT(deepest(world), 1e-9) << "at the start";
    for (int t = 0; t < (test::k_slow_build ? 40 : 110); ++t) {
      world.step();
      ASSERT_LT(deepest(world), 1e-9) << "seed " << seed << ", tick " << world.tick();
      most_carried = std::max(most_carried, world.view().counts().carried);
    }
  }
  EXPECT_GE(most_carried, 4u);
}

TEST(Links, TheSameOnAnyThreadsAndTiles) {
  for (const SceneBuilder& scene : {machines(3), carriers(2)}) {
    std::vector<std::uint64_t> expected;
    for (const WorldOptions& options : {WorldOptions{1, 0}, {2, 0}, {8, 0}, {2, 0.6}, {3, 4.7}}) {
      World world = scene.world(options);
      std::vector<std::uint64_t> hashes;
      for (int t = 0; t < 40; ++t) {
        world.step();
        hashes.push_back(world.hashes().state);
      }
      if (expected.empty()) expected = hashes;
      EXPECT_EQ(hashes, expected);
    }
  }
}

/// Adds many small bodies far away: cells are as wide as most bodies are.
void make_cells_small(SceneBuilder& scene) {
  const TypeId crumb = scene.type("crumb", {box(0.1, 0.1, 0.1)}, {.pushable = true});
  for (int i = 0; i < 900; ++i)
    scene.body(fmt::format("crumb{}", i), crumb, {9 + 0.2 * (i % 30), 0.2 * (i / 30), 0, 0});
}

/// The rectangle of a block of a body that stands at a pose.
Ring at(const Pose& pose, Ring ring) {
  for (Vec2& v : ring) v = moved({}, pose, v);
  return ring;
}

/// Sweepers, which turn long arms and push what these meet; machines that stand, slide and grip; and pucks,
/// some with an arm of their own, which go far in a tick while joints move.
SceneBuilder sweepers(std::uint64_t seed) {
  SceneBuilder scene;
  scene.spec.seed = seed;
  Random random(seed, 9, 0, 0);
  std::vector<Ring> taken;
  const auto place = [&](const std::string& name, TypeId type, const std::vector<Ring>& rings) {
    for (int tries = 0; tries < 200; ++tries) {
      const Pose pose{random.uniform(-1.4, 1.4), random.uniform(-1.4, 1.4), 0, random.uniform(-k_pi, k_pi)};
      std::vector<Ring> placed;
      for (const Ring& ring : rings) placed.push_back(at(pose, ring));
      const bool is_free = std::ranges::none_of(placed, [&](const Ring& a) {
        return std::ranges::any_of(taken, [&](const Ring& b) { return depth(a, b) > -1e-3; });
      });
      if (!is_free) continue;
      taken.insert(taken.end(), placed.begin(), placed.end());
      scene.body(name, type, pose);
      return;
    }
  };
  for (int i = 0; i < 3; ++i) {
    const std::string name = fmt::format("sweeper{}", i);
    const std::vector<Ring> rings{test::box_ring(0.2, 0.2),
                                  test::rectangle(0.1, -0.04, random.uniform(0.5, 1.1), 0.04)};
    const TypeId type = scene.robot(name, {{{rings[0]}, {0, 0.3}}, {{rings[1]}, {0, 0.3}}});
    scene[type].drive = test::drive("diff", {{"turn_min", -5.0}, {"turn_max", 5.0}});
    std::vector<Record> legs;
    for (int t = 1; t < 6; ++t)
      legs.push_back(test::leg(t, seed % 2 == 0 ? 0 : random.uniform(-0.6, 0.6), random.uniform(-5, 5)));
    scene[type].controllers.push_back(test::drive_legs(legs));
    place(name, type, rings);
  }
  for (int i = 0; i < 9; ++i) {
    const std::string name = fmt::format("machine{}", i);
    const TypeId type = scene.robot(name, {box(0.2, 0.2, 0.3)});
    const bool slides = i % 3 != 0;
    if (slides)
      test::add_arm(scene[type], "part", {0, 0, 0.1, 0},
                    {Solid{{test::rectangle(-0.05, -0.03, 0.1, 0.03)}, {0, 0.1}}},
                    {{"max_position", 0.8}, {"max_speed", random.uniform(0.1, 0.6)}});
    else
      test::add_device(scene[type], "part", "gripper", {0.2, 0, 0, 0});
    std::vector<Record> orders;
    for (int t = 0; t < 8; ++t)
      orders.push_back(slides ? order(0.1 + 0.7 * t, "part", "speed", t % 2 == 0 ? 1 : -1)
                              : order(0.1 + 0.9 * t, "part", t % 2 == 0 ? "close" : "open"));
    scene[type].controllers.push_back(test::operate(orders));
    std::vector<Ring> rings(1, test::box_ring(0.2, 0.2));
    if (!slides) rings.push_back(test::rectangle(0.1, -0.15, 0.3, 0.15));
    place(name, type, rings);
  }
  for (int i = 0; i < 18; ++i) {
    const std::string name = fmt::format("puck{}", i);
    const double size = random.uniform(0.05, 0.16);
    const TypeId type = scene.type(name, {box(size, 0.1, 0.2)}, {.gripper = true, .pushable = true});
    std::vector<Ring> rings(1, test::box_ring(size, 0.1));
    if (i % 4 == 0) {
      test::add_arm(scene[type], "arm", {0, 0, 0, 0},
                    {Solid{{test::rectangle(0, -0.02, 0.06, 0.02)}, {0, 0.1}}},
                    {{"max_position", 0.5}, {"max_speed", 0.5}});
      scene[type].controllers.push_back(
          test::operate({order(0.1, "arm", "speed", 1), order(3, "arm", "speed", -1)}));
      rings.push_back(test::rectangle(0, -0.02, 0.06, 0.02));
    }
    place(name, type, rings);
  }
  return scene;
}

// A body that was pushed lies farther from where the index has it than any robot drove in the tick: a turn
// alone pushes, too.
TEST(Links, WhatIsPushedIsMetByJointsOnAnyTiles) {
  for (std::uint64_t seed = 1; seed <= (test::k_slow_build ? 2u : 10u); ++seed) {
    SceneBuilder scene = sweepers(seed);
    const std::size_t bodies = scene.spec.bodies.size();
    make_cells_small(scene);
    std::vector<std::uint64_t> expected;
    for (const WorldOptions& options : {WorldOptions{1, 40}, {1, 0.1}, {2, 0.5}, {1, 0.8}}) {
      World world = scene.world(options);
      ASSERT_LT(deepest(world, bodies), 1e-9) << "at the start";
      for (std::size_t t = 0; t < 40; ++t) {
        world.step();
        const std::uint64_t hash = world.hashes().state;
        if (t == expected.size()) expected.push_back(hash);
        ASSERT_EQ(hash, expected[t]) << "seed " << seed << ", tick " << t + 1 << ", tiles of "
                                     << options.tile_size_m;
        if (options.tile_size_m == 40) continue;
        ASSERT_LT(deepest(world, bodies), 1e-9)
            << "seed " << seed << ", tick " << t + 1 << ", tiles of " << options.tile_size_m;
      }
    }
  }
}

// The sweeper's arm turns by 0.3 rad in the first tick and takes the puck 0.3 m along, to the tip of the
// slide, which is about to go on by 50 mm.
TEST(Links, ASlideStopsAtAPuckThatWasJustSweptBeforeIt) {
  for (int k = 0; k <= 10; ++k)
    for (int offset = 0; offset < 8; ++offset) {
      const double x = 0.04 * offset;
      const double arm = x + 0.74 + 0.01 * k;
      SceneBuilder scene;
      const TypeId machine = scene.robot("machine", {box(0.2, 0.2, 0.3)});
      test::add_arm(scene[machine], "slide", {0, 0, 0.1, 0},
                    {Solid{{test::rectangle(0, -0.03, 0.29, 0.03)}, {0, 0.1}}},
                    {{"max_position", 0.4}, {"max_speed", 0.5}});
      scene[machine].controllers.push_back(test::operate({order(0, "slide", "speed", 0.5)}));
      scene.body("machine", machine, {x, 0, 0, 0});
      const TypeId puck = scene.type("puck", {box(0.1, 0.1, 0.3)}, {.pushable = true});
      const BodyId swept = scene.body("puck", puck, {arm - 0.101, 0, 0, 0});
      const TypeId sweeper = scene.robot(
          "sweeper", {box(0.2, 0.2, 0.3), Solid{{test::rectangle(0.1, -0.05, 1.2, 0.05)}, {0, 0.3}}});
      scene[sweeper].drive = test::drive("diff", {{"turn_min", -5.0}, {"turn_max", 5.0}});
      scene[sweeper].controllers.push_back(test::drive_legs({test::leg(0.15, 0, 3)}));
      scene.body("sweeper", sweeper, {arm, -1, 0, k_pi / 2});
      make_cells_small(scene);
      World world = scene.world({1, 0.1});
      ASSERT_LT(world.view().geometry().cell_m, 0.35);
      for (int t = 0; t < 3; ++t) {
        world.step();
        EXPECT_LT(deepest(world, 4), 1e-9)
            << "tick " << world.tick() << ", arm at " << arm << ", offset " << x;
      }
      if (k > 3) {
        EXPECT_LT(world.view().pose(swept).x - x, 0.5) << "it was swept";
      }
    }
}

/// Adds a car to a type: a part with a drive of its own, whose place at rest is `pose`, and that drives these
/// legs at up to `most_mps`.
void add_car(TypeSpec& type, const Pose& pose, double most_mps, std::vector<Record> legs) {
  const std::size_t wheels = test::add_device(type, "car", "wheels", pose,
                                              {{"velocity_min_x", -most_mps}, {"velocity_max_x", most_mps}});
  PartSpec part{.name = "car", .kind = "position", .joint = type.devices[wheels].moves};
  part.pose_body_part = pose;
  part.solids.push_back(placed(Solid{{test::box_ring(0.2, 0.2)}, {0, 0.1}}, pose));
  type.parts.push_back(std::move(part));
  const auto car = static_cast<std::uint32_t>(type.parts.size() - 1);
  type.devices[wheels].part = car;
  ControllerSpec controller = test::drive_legs(std::move(legs));
  controller.part = car;
  type.controllers.push_back(std::move(controller));
}

/// Robots that drive and turn, and whose cars drive about among all of them, metres away from their bodies.
SceneBuilder cars() {
  SceneBuilder scene;
  for (int i = 0; i < 12; ++i) {
    const std::string name = fmt::format("c{}", i);
    const TypeId type = scene.robot(name, {box(0.3, 0.3, 0.5)});
    scene[type].controllers.push_back(
        test::drive_legs({test::leg(20, 0.1 * (i % 3 - 1), 0.05 * (i % 5 - 2))}));
    std::vector<Record> legs;
    for (int k = 0; k < 12; ++k)
      legs.push_back(test::leg(0.5 * (k + 1), (k % 3 == 2 ? -1 : 1.5) * (1 + 0.25 * ((i + k) % 5)),
                               0.35 * ((3 * i + k) % 5 - 2)));
    add_car(scene[type], {0.4, 0, 0.1, 0}, 5, std::move(legs));
    const int row = i / 3;
    scene.body(name, type, {1.2 * (i % 3), 1.2 * row, 0, 0.7 * i});
  }
  return scene;
}

// A body whose car is far away has a wide circle. The index lists it in all cells that the circle touches,
// and its radius is not the one for which the index was built.
TEST(Links, CarsFarFromTheirBodiesMeetOneAnotherOnAnyTiles) {
  const SceneBuilder scene = cars();
  std::vector<std::uint64_t> expected;
  double farthest = 0;
  std::size_t stalls = 0;
  for (const WorldOptions& options : {WorldOptions{1, 0}, {2, 0}, {1, 0.1}, {3, 4.7}}) {
    World world = scene.world(options);
    for (std::size_t t = 0; t < (test::k_slow_build ? 20u : 60u); ++t) {
      world.step();
      const std::uint64_t hash = world.hashes().state;
      if (t == expected.size()) expected.push_back(hash);
      ASSERT_EQ(hash, expected[t]) << "tick " << t + 1 << ", tiles of " << options.tile_size_m;
      ASSERT_LT(deepest(world), 1e-9) << "tick " << t + 1;
      for (std::uint32_t b = 1; b <= 12; ++b) {
        farthest =
            std::max(farthest, world.state().joint_state(world.view().row(BodyId(b)), 0).position().norm());
        stalls += test::state_of<models::WheelsState>(world, BodyId(b), 0).stalled;
      }
    }
  }
  EXPECT_GT(farthest, 2) << "they leave their bodies";
  EXPECT_GT(stalls, 20u) << "and are in one another's way";
}

// The motion of a car has hundreds of samples. Each of them meets each other tree once, not once for each of
// the thousands of cells in which the index lists it.
TEST(Links, CarsFarFromTheirBodiesMoveQuickly) {
  SceneBuilder scene;
  const TypeId type = scene.robot("bot", {box(0.3, 0.3, 0.3)});
  add_car(scene[type], {0, 0, 0.3, 0}, 300, {test::leg(9, 300)});
  for (int i = 0; i < 5; ++i) scene.body(fmt::format("b{}", i), type, {0, 2.0 * i, 0, 0});
  World world = scene.world({1, 0});
  const std::clock_t start = std::clock();
  for (int t = 0; t < 3; ++t) world.step();
  if (!test::k_slow_build) {
    EXPECT_LT(std::clock() - start, 3 * CLOCKS_PER_SEC);  // processor time
  }
  EXPECT_NEAR(world.state().joint_state(world.view().row(BodyId(5)), 0).x, 60, 1e-9);
}

// The tip of each slide is 0.1 mm thick, and moves by 500 m in a tick: its samples are 5 cm apart.
TEST(Links, AMotionHasAtMostTenThousandSamples) {
  SceneBuilder scene;
  const TypeId type = scene.robot("bot", {box(0.3, 0.3, 0.3)});
  test::add_arm(scene[type], "slide", {0, 0, 0.5, 0},
                {Solid{{test::rectangle(0, -0.05, 1e-4, 0.05)}, {0, 0.1}}},
                {{"max_position", 900.0}, {"max_speed", 5000.0}});
  scene[type].controllers.push_back(test::operate({order(0, "slide", "speed", 5000)}));
  const BodyId passes = scene.body("passes", type, {0, 0, 0, 0});
  const BodyId blocked = scene.body("blocked", type, {0, 5, 0, 0});
  scene.wall(100.01, -0.01, 100.04, 0.01);  // between two samples
  scene.wall(100.01, 4.99, 100.07, 5.01);
  World world = scene.world({1, 0});
  while (world.tick() < 4 && world.state().joint_state(world.view().row(passes), 0).x == 0) world.step();
  EXPECT_EQ(world.state().joint_state(world.view().row(passes), 0).x, 500);
  EXPECT_EQ(world.state().joint_state(world.view().row(blocked), 0).x, 0);
}

TEST(Links, AResetAndAnotherRunAreTheSame) {
  World world = machines(5).world();
  for (int t = 0; t < 30; ++t) world.step();
  const std::uint64_t after = world.hashes().state;
  world.reset();
  for (int t = 0; t < 30; ++t) world.step();
  EXPECT_EQ(world.hashes().state, after);
}

/// Who carries whom is refused where it would make no tree.
TEST(Links, CyclesAndTakenBodiesAreRefused) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.2, 0.2)});
  test::add_device(scene[type], "hand", "gripper", {0.2, 0, 0, 0});
  for (int i = 0; i < 3; ++i) scene.body(fmt::format("r{}", i), type, {2.0 * i, 0, 0, 0.5 * i});
  const TypeId plain = scene.robot("plain", {box(0.2, 0.2)});
  scene.body("p", plain, {0, 3, 0, 0});
  World world = scene.world();
  const Row a = world.view().row(BodyId(1)), b = world.view().row(BodyId(2)), c = world.view().row(BodyId(3)),
            p = world.view().row(BodyId(4));
  EXPECT_TRUE(test::access_of(world).links().attach(b, a, k_rigid));
  EXPECT_TRUE(test::access_of(world).links().attach(c, b, 0));
  EXPECT_FALSE(test::access_of(world).links().attach(c, a, k_rigid)) << "taken";
  EXPECT_FALSE(test::access_of(world).links().attach(a, c, k_rigid)) << "a circle";
  EXPECT_FALSE(test::access_of(world).links().attach(a, a, k_rigid)) << "itself";
  EXPECT_FALSE(test::access_of(world).links().attach(a, p, k_rigid)) << "it has no hands";
  EXPECT_TRUE(world.view().same_tree(a, c));
  EXPECT_EQ(world.view().counts().carried, 2u);
  const Pose before = world.view().pose(BodyId(3));
  for (int t = 0; t < 3; ++t) world.step();
  EXPECT_NEAR(world.view().pose(BodyId(3)).x, before.x, 1e-12);
  EXPECT_NEAR(world.view().pose(BodyId(3)).heading, before.heading, 1e-12);
  test::access_of(world).links().release(b);
  EXPECT_FALSE(world.view().same_tree(a, b));
  EXPECT_TRUE(world.view().same_tree(b, c));
  test::access_of(world).links().release(b);
  EXPECT_EQ(world.view().counts().carried, 1u);
}

/// Copies the state of a world to the tables of another world of the same scene.
void copy_tables(const World& from, std::span<StateTable> tables) {
  for (std::size_t i = 0; i < tables.size(); ++i)
    for (std::size_t f = 0; f < tables[i].fields().size(); ++f)
      for (std::size_t r = 0; r < tables[i].rows(); ++r) {
        const StateField& field = tables[i].fields()[f];
        std::copy_n(reinterpret_cast<const std::byte*>(from.tables()[i].cell<std::uint8_t>(r, f).data()),
                    element_size(field.element) * field.columns,
                    reinterpret_cast<std::byte*>(tables[i].cell<std::uint8_t>(r, f).data()));
      }
}

/// In a longer chain, functions that visit all its bodies would exhaust the stack.
TEST(Links, AChainOfCarriersHasALimit) {
  constexpr std::size_t k_most = Links::k_most_carriers;
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.2, 0.2)});
  test::add_device(scene[type], "hand", "gripper", {0.2, 0, 0, 0});
  for (std::size_t i = 0; i < k_most + 2; ++i)
    scene.body(fmt::format("r{}", i), type, {2 * static_cast<double>(i), 0, 0, 0});
  const auto attach = [](World& world, std::size_t i) {  // body i carries body i + 1
    return test::access_of(world).links().attach(world.view().row(BodyId(i + 1)), world.view().row(BodyId(i)),
                                                 k_rigid);
  };
  World chain = scene.world();
  World none = scene.world();
  // A state hash is a sum over the rows, so that of a state which attach() would refuse can be computed.
  const auto can_restore_with = [&](std::size_t i) {
    World link = scene.world();
    EXPECT_TRUE(attach(link, i));
    return scene.world().restore(
        0, none.counters(), chain.hashes().state + link.hashes().state - none.hashes().state,
        [&](std::span<StateTable> tables) {
          copy_tables(chain, tables);
          const auto carrier = std::ranges::find(tables, "carrier", &StateTable::component);
          const StateTable& linked = link.tables()[static_cast<std::size_t>(carrier - tables.begin())];
          const std::size_t row = link.view().row(BodyId(i + 1)).index();
          carrier->as<Carried>(row) = linked.as<Carried>(row);
        });
  };
  for (std::size_t i = 1; i < k_most; ++i) ASSERT_TRUE(attach(chain, i)) << i;
  EXPECT_TRUE(can_restore_with(k_most));
  EXPECT_TRUE(attach(chain, k_most));
  EXPECT_FALSE(can_restore_with(k_most + 1));
  EXPECT_FALSE(attach(chain, k_most + 1)) << "behind the last body";
  World other = scene.world();
  for (std::size_t i = k_most + 1; i > 1; --i) ASSERT_TRUE(attach(other, i)) << i;
  EXPECT_FALSE(attach(other, 1)) << "in front of the first body";
}

/// The whole state comes back, joints and carriers with it; what makes no tree does not.
TEST(Links, AStoredStateGoesOn) {
  SceneBuilder scene = machines(2);
  const TypeId hand = scene.robot("hand", {box(0.2, 0.2)});
  test::add_device(scene[hand], "hand", "gripper", {0.2, 0, 0, 0});
  const BodyId by = scene.body("h", hand, {9, 0, 0, 0});
  const BodyId what = scene.body("w", hand, {9.5, 0, 0, 1});
  World first = scene.world();
  World second = scene.world();
  ASSERT_TRUE(test::access_of(first).links().attach(first.view().row(what), first.view().row(by), 0));
  for (int t = 0; t < 20; ++t) first.step();
  const auto copy = [&](std::span<StateTable> tables) { copy_tables(first, tables); };
  ASSERT_TRUE(second.restore(first.tick(), first.counters(), first.hashes().state, copy));
  EXPECT_EQ(second.view().carrier(second.view().row(what)), by);
  for (int t = 0; t < 20; ++t) {
    first.step();
    second.step();
    ASSERT_EQ(first.hashes().state, second.hashes().state);
  }
}

}  // namespace
}  // namespace troupe::engine::links_test
