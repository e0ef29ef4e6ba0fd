// Joints and cargo: nothing overlaps, whatever moves; and the same comes out wherever it is worked out.

#include "base/random.hpp"
#include "engine/world.hpp"
#include "tests/support/devices.hpp"
#include "tests/support/slow_build.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace troupe::engine {
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
std::vector<Block> blocks_of(const World& world) {
  std::vector<Block> blocks;
  const WorldSpec& spec = world.spec();
  for (std::size_t b = 1; b < spec.bodies.size(); ++b) {
    const BodyId body(b);
    const Row row = world.row(body);
    BodyId tree = body;
    while (row.valid() && world.carrier(world.row(tree))) tree = *world.carrier(world.row(tree));
    const Pose pose = world.pose(body);
    const TypeSpec& type = spec.types[spec.bodies[b].type.index()];
    for (const PartSpec& part : type.parts)
      for (const Solid& solid : part.solids) {
        Block block{tree, {}, solid.z.shifted(pose.z)};
        for (Vec2 p : solid.contours[0]) {
          if (part.joint != k_rigid)
            p = moved(type.joints[static_cast<std::size_t>(part.joint)].pose_body_joint,
                      world.joint_state(row, static_cast<std::size_t>(part.joint)), p);
          block.ring.push_back(moved({}, pose, p));
        }
        if (part.joint != k_rigid)
          block.z = block.z.shifted(world.joint_state(row, static_cast<std::size_t>(part.joint)).z);
        blocks.push_back(std::move(block));
      }
  }
  return blocks;
}

/// The deepest overlap of blocks of different trees, m; 0 or less: none.
double deepest(const World& world) {
  const std::vector<Block> blocks = blocks_of(world);
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
      most_carried = std::max(most_carried, world.carried_count());
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
  const Row a = world.row(BodyId(1)), b = world.row(BodyId(2)), c = world.row(BodyId(3)),
            p = world.row(BodyId(4));
  EXPECT_TRUE(world.attach(b, a, k_rigid));
  EXPECT_TRUE(world.attach(c, b, 0));
  EXPECT_FALSE(world.attach(c, a, k_rigid)) << "taken";
  EXPECT_FALSE(world.attach(a, c, k_rigid)) << "a circle";
  EXPECT_FALSE(world.attach(a, a, k_rigid)) << "itself";
  EXPECT_FALSE(world.attach(a, p, k_rigid)) << "it has no hands";
  EXPECT_TRUE(world.same_tree(a, c));
  EXPECT_EQ(world.carried_count(), 2u);
  const Pose before = world.pose(BodyId(3));
  for (int t = 0; t < 3; ++t) world.step();
  EXPECT_NEAR(world.pose(BodyId(3)).x, before.x, 1e-12);
  EXPECT_NEAR(world.pose(BodyId(3)).heading, before.heading, 1e-12);
  world.release(b);
  EXPECT_FALSE(world.same_tree(a, b));
  EXPECT_TRUE(world.same_tree(b, c));
  world.release(b);
  EXPECT_EQ(world.carried_count(), 1u);
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
  ASSERT_TRUE(first.attach(first.row(what), first.row(by), 0));
  for (int t = 0; t < 20; ++t) first.step();
  const auto copy = [&](std::span<StateTable> tables) {
    for (std::size_t i = 0; i < tables.size(); ++i)
      for (std::size_t f = 0; f < tables[i].fields().size(); ++f)
        for (std::size_t r = 0; r < tables[i].rows(); ++r) {
          const StateField& field = tables[i].fields()[f];
          std::copy_n(reinterpret_cast<const std::byte*>(first.tables()[i].cell<std::uint8_t>(r, f).data()),
                      element_size(field.element) * field.columns,
                      reinterpret_cast<std::byte*>(tables[i].cell<std::uint8_t>(r, f).data()));
        }
  };
  ASSERT_TRUE(second.restore(first.tick(), first.counters(), first.hashes().state, copy));
  EXPECT_EQ(second.carrier(second.row(what)), by);
  for (int t = 0; t < 20; ++t) {
    first.step();
    second.step();
    ASSERT_EQ(first.hashes().state, second.hashes().state);
  }
}

}  // namespace
}  // namespace troupe::engine
