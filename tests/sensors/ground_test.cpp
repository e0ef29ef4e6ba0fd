#include "sensors/ground.hpp"

#include "base/random.hpp"
#include "engine/observing/frame.hpp"
#include "engine/sensing/sight.hpp"
#include "engine/world/world.hpp"
#include "models/devices/brush.hpp"
#include "models/devices/led.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scene.hpp"
#include "tests/support/slow_build.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace troupe::sensors::ground_test {
namespace {

using engine::World;
using models::BrushCommand;
using models::LedCommand;
using test::box;
using test::device;
using test::SceneBuilder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

engine::Value rgb(double r, double g, double b) { return std::vector<double>{r, g, b}; }

/// Paints what is below it in a colour of its own: red after its id.
struct Painter {
  static constexpr std::array k_uses{std::string_view("brush")};
  void operator()(const engine::Percept& percept, Random&, engine::Actions& actions) const {
    actions.device<BrushCommand>(0).paint(static_cast<float>(percept.body) / 16, 0, 1);
  }
};

/// Shows green in tick 2, and leaves it at that.
struct Signaller {
  static constexpr bool needs_drive = false;
  static constexpr std::array k_uses{std::string_view("led")};
  void operator()(const engine::Percept& percept, Random&, engine::Actions& actions) const {
    if (percept.tick == 2) actions.device<LedCommand>(0).show(0, 7, -1);
    if (percept.tick == 3) actions.device<LedCommand>(0).shows = 0;
  }
};

const engine::Registry& registry() {
  static const engine::Registry kinds = [] {
    engine::Registry all = make_registry();
    all.controllers.push_back(engine::make_controller_kind<Painter>("painter", ""));
    all.controllers.push_back(engine::make_controller_kind<Signaller>("signaller", ""));
    return all;
  }();
  return kinds;
}

struct GroundScene : SceneBuilder {
  BodyId zone(double x, double y, double size, const Color& color, double height = 0.01,
              const std::vector<engine::DeviceSpec>& devices = {}, double heading = 0) {
    const std::string name = "zone" + std::to_string(spec.bodies.size());
    const TypeId id = type(name, {box(size, size, height)}, {.obstacle = false, .ranger = -1});
    (*this)[id].devices = devices;
    const BodyId body = SceneBuilder::body(name, id, {x, y, 0, heading});
    spec.bodies[body.index()].color = color;
    return body;
  }
  BodyId robot_with(const std::vector<engine::DeviceSpec>& devices, const Pose& pose,
                    const std::string& controller = {}) {
    const std::string name = "robot" + std::to_string(spec.bodies.size());
    const TypeId id = robot(name, {box(0.2, 0.2, 0.2)});
    (*this)[id].devices = devices;
    if (!controller.empty()) (*this)[id].controllers = {{.kind = controller, .params = {}, .where = {}}};
    return body(name, id, pose);
  }
  World world(engine::WorldOptions options = {.threads = 2}) const {
    Diagnostics diagnostics;
    return World(spec, registry(), options, diagnostics);
  }
};

template <class T>
std::vector<T> read(const World& world, BodyId body, std::size_t field, std::size_t d = 0) {
  const Row row = world.view().row(body);
  const auto cell =
      world.tables()[world.view().type(row).devices[d].table].cell<T>(world.view().slot(row), field);
  return {cell.begin(), cell.end()};
}

TEST(Ground, EachPointHasTheColourOfWhatLiesBelowIt) {
  GroundScene scene;
  const BodyId red = scene.zone(0, 0, 2, {1, 0, 0, 1});
  const BodyId blue = scene.zone(0.5, 0, 0.4, {0, 0, 1, 1}, 0.02);  // on top of it
  scene.zone(0, 5, 2, {0, 1, 0, 1}, 0.5);                           // too high to be ground
  const BodyId robot = scene.robot_with(
      {device("ground",
              {{"points", std::vector<double>{0, 0, 0.5, 0, 0.5, 1.5}}, {"floor", rgb(0.5, 0.25, 0)}})},
      {0, 0, 0, 0});
  World world = scene.world();
  world.step();
  EXPECT_THAT(read<float>(world, robot, k_ground_color), ElementsAre(1, 0, 0, 0, 0, 1, 0.5f, 0.25f, 0));
  EXPECT_THAT(read<std::uint32_t>(world, robot, k_ground_body), ElementsAre(red.value, blue.value, 0u));
  world.set_poses(std::vector<World::Placed>{{world.view().row(robot), {0, 5, 0, -k_pi / 2}}});
  world.step();
  EXPECT_THAT(read<std::uint32_t>(world, robot, k_ground_body), ElementsAre(0u, 0u, 0u));
  world.set_poses(std::vector<World::Placed>{{world.view().row(robot), {0.5, 0.5, 0, -k_pi / 2}}});
  world.step();  // its second point lies at (0.5, 0), its third at (2, 0)
  EXPECT_THAT(read<std::uint32_t>(world, robot, k_ground_body), ElementsAre(red.value, blue.value, 0u));
}

TEST(Ground, OfEqualZonesTheLowerBodysCounts) {
  GroundScene scene;
  scene.zone(0, 0, 1, {1, 0, 0, 1}, 0.01, {device("led", {{"shows", rgb(0, 1, 1)}})});
  scene.zone(0, 0, 1, {0, 1, 0, 1});
  const BodyId robot = scene.robot_with({device("ground")}, {0.1, 0.1, 0, 0});
  World world = scene.world();
  world.step();
  EXPECT_THAT(read<float>(world, robot, k_ground_color), ElementsAre(0, 1, 1)) << "that of its led";
}

TEST(Ground, HeightsOfBodiesCountAndTheLimitIsGround) {
  for (const bool fixed : {true, false}) {
    // Plates of 0.125 m: one that is raised above the limit, and one on the floor, which is as high as the
    // limit.
    GroundScene scene;
    const auto plate = [&](const std::string& name, const Pose& pose) {
      const std::vector<Solid> solids{box(1, 1, 0.125)};
      return scene.body(name, fixed ? scene.type(name, solids) : scene.robot(name, solids), pose);
    };
    plate("high", {0, 0, 0.0625, 0});
    const BodyId low = plate("low", {0, 0, 0, 0});
    const TypeId type = scene.robot("reader", {box(0.1, 0.1)});
    scene[type].devices = {device("ground", {{"height", 0.125}})};
    const BodyId reader = scene.body("reader", type);
    World world = scene.world();
    world.step();
    EXPECT_EQ(read<std::uint32_t>(world, reader, k_ground_body)[0], low.value) << fixed;
  }
}

TEST(Ground, APartHasAColourOfItsOwn) {
  for (const bool fixed : {true, false}) {
    GroundScene scene;
    const TypeId type = fixed ? scene.type("plate", {}) : scene.robot("plate", {});
    scene[type].parts.push_back({.name = "tile", .kind = "model", .solids = {box(1, 1, 0.01)}});
    scene[type].parts.back().color = Color{0, 0.25f, 0.5f, 1};
    const BodyId plate = scene.body("plate", type);
    scene.spec.bodies[plate.index()].color = {1, 0, 0, 1};
    const BodyId robot = scene.robot_with({device("ground")}, {0.1, 0.1, 0, 0});
    World world = scene.world();
    world.step();
    EXPECT_THAT(read<float>(world, robot, k_ground_color), ElementsAre(0, 0.25f, 0.5f)) << fixed;
  }
}

TEST(Ground, APointOnABorderLiesInOneTile) {
  GroundScene scene;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) scene.zone(i, j, 1, {0, 0, 0, 1});
  std::vector<BodyId> robots;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      robots.push_back(scene.robot_with({device("ground")}, {i + 0.5, j + 0.5, 0, 0}));
  World world = scene.world();
  world.step();
  for (const BodyId robot : robots) EXPECT_NE(read<std::uint32_t>(world, robot, k_ground_body)[0], 0u);
}

/// A comb with uneven teeth and holes, as the outlines of a floor image have: each point has the colour that
/// the even-odd rule gives it.
TEST(Ground, AZoneWithManyEdgesHoldsThePointsInsideIt) {
  Random random(3, 7, 0, 0);
  Solid comb{{{{-5, -5}}}, {0, 0.01}};
  for (int i = 0; i < 100; ++i) {
    comb.contours[0].emplace_back(-5 + 0.1 * i, random.uniform(-4.9, 5));
    comb.contours[0].emplace_back(-5 + 0.1 * i + 0.05, random.uniform(-4.9, 5));
  }
  comb.contours[0].emplace_back(5, -5);
  for (int i = 0; i < 40; ++i) {
    const Vec2 at(random.uniform(-4, 4), random.uniform(-4, 4));
    comb.contours.push_back({at, at + Vec2(0.7, 0.1), at + Vec2(0.2, 0.9)});
  }
  std::vector<Vec2> points;
  std::vector<double> numbers;
  for (int i = 0; i < 1000; ++i) {
    points.emplace_back(random.uniform(-5.5, 5.5), random.uniform(-5.5, 5.5));
    numbers.insert(numbers.end(), {points.back().x(), points.back().y()});
  }
  GroundScene scene;
  const BodyId zone =
      scene.body("zone", scene.type("zone", {comb}, {.obstacle = false, .ranger = -1}), {0, 0, 0, 0});
  const BodyId robot = scene.robot_with({device("ground", {{"points", numbers}})}, {0, 0, 0, 0});
  World world = scene.world();
  world.step();
  const std::vector<std::uint32_t> bodies = read<std::uint32_t>(world, robot, k_ground_body);
  std::size_t inside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(bodies[i], contains(comb, points[i]) ? zone.value : 0u) << i;
    inside += bodies[i] != 0;
  }
  EXPECT_GT(inside, 200u);
  EXPECT_LT(inside, 800u);
}

TEST(Ground, APointOnASlantedBorderLiesInOneOfTwoZones) {
  for (int i = 1; i <= 9; ++i)
    for (int j = 1; j <= 9; ++j) {
      const Vec2 end(0.1 * i, 0.1 * j);  // the border begins at (0, 0)
      GroundScene scene;
      const auto zone = [&](const std::string& name, const Ring& ring, double height) {
        const TypeId id = scene.type(name, {Solid{{ring}, {0, height}}}, {.obstacle = false, .ranger = -1});
        return scene.body(name, id);
      };
      const BodyId left = zone("left", {{0, 0}, end, {-1, 1}}, 0.01);
      const BodyId right = zone("right", {{0, 0}, {1, -1}, end}, 0.02);
      std::vector<double> points;
      for (int k = 1; k <= 9; ++k) points.insert(points.end(), {0.1 * k * end.x(), 0.1 * k * end.y()});
      engine::DeviceSpec lower = device("ground", {{"points", points}, {"height", 0.015}});
      lower.name = "lower";
      const BodyId robot = scene.robot_with({lower, device("ground", {{"points", points}})}, {});
      World world = scene.world();
      world.step();
      const auto only_left = read<std::uint32_t>(world, robot, k_ground_body, 0);
      const auto both = read<std::uint32_t>(world, robot, k_ground_body, 1);  // the right zone is above
      for (std::size_t k = 0; k < both.size(); ++k)
        EXPECT_NE(only_left[k] == left.value, both[k] == right.value) << i << " " << j << " " << k + 1;
    }
}

TEST(Ground, AZoneIsSeenThoughARootWithoutSolidsHasAGripperReturn) {
  GroundScene scene;
  const TypeId id = scene.type("zone", {}, {.obstacle = false, .ranger = -1, .gripper = true});
  scene[id].parts.push_back({.name = "p",
                             .kind = "model",
                             .solids = {box(1, 1, 0.01)},
                             .returns = {.obstacle = false, .ranger = -1},
                             .color = Color{1, 0, 0, 1}});
  const BodyId zone = scene.body("zone", id);
  const BodyId robot = scene.robot_with({device("ground")}, {});
  World world = scene.world();
  world.step();
  EXPECT_THAT(read<float>(world, robot, k_ground_color), ElementsAre(1, 0, 0));
  EXPECT_THAT(read<std::uint32_t>(world, robot, k_ground_body), ElementsAre(zone.value));
}

TEST(Led, ShowsItsColourToAllThatLook) {
  GroundScene scene;
  const TypeId id = scene.type("post", {box(0.2, 0.2)});
  scene[id].devices = {device("led", {{"shows", rgb(0.5, 0, 1)}})};
  scene[id].controllers = {{.kind = "signaller", .params = {}, .where = {}}};
  const BodyId post = scene.body("post", id, {2, 0, 0, 0});
  World world = scene.world();
  const auto seen = [&] { return color_of(world.view(), first_met(world.view(), {.length = 9})); };
  EXPECT_EQ(seen(), (Color{0.5f, 0, 1, 1}));
  EXPECT_EQ(engine::make_frame(world).mobile.front().color, (Color{0.5f, 0, 1, 1}));
  world.step();
  world.step();
  EXPECT_EQ(seen(), (Color{0.5f, 0, 1, 1})) << "it was asked just now";
  world.step();
  EXPECT_EQ(seen(), (Color{0, 1, 0, 1})) << "kept within 0 and 1";
  world.step();
  world.step();
  EXPECT_EQ(seen(), (Color{0, 1, 0, 1})) << "and stays so";
  EXPECT_EQ(engine::make_frame(world).mobile.front().color, (Color{0, 1, 0, 1}));
  EXPECT_THAT(read<float>(world, post, 0), ElementsAre(0, 1, 0));
}

TEST(Brush, PaintsTheZoneBelow) {
  GroundScene scene;
  const BodyId paper = scene.zone(0, 0, 1, {1, 1, 1, 1}, 0.01, {device("led")});
  const BodyId stone = scene.zone(3, 0, 1, {1, 1, 1, 1});
  const BodyId painter =
      scene.robot_with({device("brush", {}, {0.3, 0, 0, 0}), device("ground")}, {0, 0, 0, 0}, "painter");
  const BodyId other = scene.robot_with({device("brush"), device("ground")}, {3, 0, 0, 0}, "painter");
  World world = scene.world();
  world.step();
  EXPECT_THAT(read<float>(world, paper, 0), ElementsAre(1, 1, 1));
  world.step();
  const float red = static_cast<float>(painter.value) / 16;
  EXPECT_THAT(read<float>(world, paper, 0), ElementsAre(red, 0, 1));
  EXPECT_THAT(read<float>(world, painter, k_ground_color, 1), ElementsAre(1, 1, 1))
      << "before it was painted";
  world.step();
  EXPECT_THAT(read<float>(world, painter, k_ground_color, 1), ElementsAre(red, 0, 1));
  EXPECT_EQ(read<std::uint64_t>(world, painter, 0)[0], 1u) << "painted once, the same since";
  EXPECT_THAT(read<float>(world, other, k_ground_color, 1), ElementsAre(1, 1, 1)) << "what has no led stays";
  EXPECT_EQ(read<std::uint32_t>(world, other, k_ground_body, 1)[0], stone.value);
  EXPECT_EQ(read<std::uint64_t>(world, other, 0)[0], 0u);
}

TEST(Brush, OfSeveralTheHighestIdHasItInTheEnd) {
  GroundScene scene;
  const BodyId paper = scene.zone(0, 0, 1, {1, 1, 1, 1}, 0.01, {device("led")});
  scene.robot_with({device("brush")}, {0.3, 0, 0, 0}, "painter");
  const BodyId last = scene.robot_with({device("brush")}, {-0.3, 0, 0, 0}, "painter");
  for (const unsigned threads : {1u, 2u, 8u}) {
    World world = scene.world({.threads = threads});
    world.step();
    world.step();
    EXPECT_THAT(read<float>(world, paper, 0), ElementsAre(static_cast<float>(last.value) / 16, 0, 1));
  }
}

TEST(Brush, ThreadsAndTilesChangeNothing) {
  GroundScene scene;
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) scene.zone(0.5 * i, 0.5 * j, 0.5, {1, 1, 1, 1}, 0.01, {device("led")});
  const TypeId id = scene.robot("painter", {box(0.1, 0.1, 0.1)});
  scene[id].devices = {device("brush"), device("ground")};
  scene[id].controllers = {{.kind = "painter", .params = {}, .where = {}},
                           test::controller("script", {{"law", "wave"}})};
  Random random(3, 0, 0, 0);
  for (int i = 0; i < 60; ++i)
    scene.body("p" + std::to_string(i), id,
               {random.uniform(0, 6), random.uniform(0, 6), 0, random.uniform(-3, 3)});
  std::vector<std::uint64_t> first;
  for (const auto& [threads, tile_m] : {std::pair(1u, 0.0), std::pair(2u, 0.5), std::pair(8u, 3.0)}) {
    World world = scene.world({.threads = threads, .tile_size_m = tile_m});
    std::vector<std::uint64_t> states;
    for (int tick = 0; tick < (test::k_slow_build ? 5 : 50); ++tick) {
      world.step();
      states.push_back(world.hashes().state);
    }
    if (first.empty()) first = states;
    EXPECT_EQ(states, first) << threads << " threads";
  }
}

TEST(Ground, WhatCannotBeIsAnError) {
  GroundScene scene;
  scene.robot_with({device("ground", {{"points", std::vector<double>{0, 1, 2}}})}, {});
  EXPECT_THAT(test::message_of<InputError>([&] { scene.world(); }),
              HasSubstr("device \"ground\" needs an even number of values in \"points\", at least 2 (x "
                        "and y of each point), found "));
}

}  // namespace
}  // namespace troupe::sensors::ground_test
