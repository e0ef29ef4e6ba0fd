#include "sensors/camera.hpp"

#include "base/random.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scene.hpp"
#include "tests/support/slow_build.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace troupe::sensors::camera_test {
namespace {

using engine::World;
using test::box;
using test::SceneBuilder;
using Params = std::initializer_list<std::pair<std::string_view, engine::Value>>;

constexpr double k_eye = 0.5;  // m: height of the camera

engine::Record camera(Params params, Params more = {}) {
  const engine::FieldTable& table = test::registry().device("camera")->params;
  engine::Record record = test::record(table, params);
  for (const auto& [name, value] : more) record.at(static_cast<std::size_t>(table.find(name))) = value;
  return record;
}

/// A robot at the origin that looks along +x, and what the test adds.
struct CameraScene : SceneBuilder {
  explicit CameraScene(const engine::Record& params, const Pose& pose = {}) {
    const TypeId type = robot("robot", {box(0.3, 0.3)});
    (*this)[type].devices = {{.name = "camera",
                              .kind = "camera",
                              .params = params,
                              .pose_body_device = {0, 0, k_eye, 0},
                              .where = {}}};
    body("r", type, pose);
  }
  void block(const Color& color, const Pose& pose, const Solid& solid) {
    const std::string name = "block" + std::to_string(spec.bodies.size());
    spec.bodies[body(name, type(name, {solid}), pose).index()].color = color;
  }
};

struct Picture {
  explicit Picture(const SceneBuilder& scene, engine::WorldOptions options = {.threads = 2}) {
    World world = scene.world(options);
    world.step();
    const Row row = world.view().row(BodyId(1));
    const engine::StateTable& table = world.tables()[world.view().type(row).devices[0].table];
    const auto color = table.cell<std::uint8_t>(world.view().slot(row), k_camera_color);
    const auto depths = table.cell<float>(world.view().slot(row), k_camera_depth);
    for (std::size_t i = 0; i < depths.size(); ++i)
      colors.push_back(color[4 * i] << 16 | color[4 * i + 1] << 8 | color[4 * i + 2]);
    depth.assign(depths.begin(), depths.end());
  }
  std::vector<int> colors;  ///< 0xRRGGBB
  std::vector<float> depth;
};

constexpr int k_red = 0xff0000;
constexpr int k_green = 0x00ff00;
constexpr int k_sky = 0x87ceeb;
constexpr int k_floor = 0xcccccc;

// Of 90 degrees each way, the picture at depth 1 reaches from -1 to 1: pixel i of four is at 0.75 - 0.5 i.
const Params k_square{
    {"width", 4}, {"height", 4}, {"fov_horizontal", radians(90)}, {"fov_vertical", radians(90)}};

TEST(Camera, AWallExactlyAtItsFarRangeIsDrawnWithItsOpacity) {
  CameraScene scene(camera({{"width", 1}, {"height", 1}, {"range_far", 2.0}}));
  scene.block({0, 1, 0, 0.6f}, {2.5, 0, 0, 0}, box(1, 1));
  World world = scene.world();
  world.step();
  const Row row = world.view().row(BodyId(1));
  const engine::StateTable& table = world.tables()[world.view().type(row).devices[0].table];
  EXPECT_THAT(table.cell<std::uint8_t>(world.view().slot(row), k_camera_color),
              ::testing::ElementsAre(0, 255, 0, 153));
  EXPECT_EQ(table.cell<float>(world.view().slot(row), k_camera_depth)[0], 2);
}

TEST(Camera, AWallItsTopAndTheFloorBeforeIt) {
  CameraScene scene(camera(k_square));
  scene.block({1, 0, 0, 1}, {3, 0, 0, 0}, {{test::box_ring(2, 20)}, {0, 0.4}});  // from 2 m to 4 m, lower
  const Picture p(scene);
  for (std::size_t column = 0; column < 4; ++column) {
    EXPECT_EQ(p.colors[column], k_sky);
    EXPECT_EQ(p.depth[column], 8);
    EXPECT_EQ(p.colors[4 + column], k_sky);
    // 0.25 down a metre: 0.5 m down is the floor at 2 m, and the top, 0.1 m down, would be met at 0.4 m: no.
    EXPECT_EQ(p.colors[8 + column], k_red);
    EXPECT_FLOAT_EQ(p.depth[8 + column], 2);
    EXPECT_EQ(p.colors[12 + column], k_floor);
    EXPECT_FLOAT_EQ(p.depth[12 + column], static_cast<float>(0.5 / 0.75));
  }
}

TEST(Camera, SeesTheTopOfWhatIsLowerAndTheUndersideOfWhatIsHigher) {
  CameraScene scene(camera(k_square));
  scene.block({1, 0, 0, 1}, {2, 0, 0, 0}, {{test::box_ring(3, 20)}, {0, 0.2}});
  scene.block({0, 1, 0, 1}, {2, 0, 0, 0}, {{test::box_ring(3, 20)}, {0.8, 1}});
  const Picture p(scene);
  EXPECT_EQ(p.colors[0], k_green);  // 0.75 up a metre: 0.3 m up at 0.4 m is before it; its face at 0.5 m is
                                    // met at 0.375 m up
  EXPECT_FLOAT_EQ(p.depth[0], 0.5);
  EXPECT_EQ(p.colors[4], k_green);  // 0.25 up: the underside, 0.3 m up, at 1.2 m
  EXPECT_FLOAT_EQ(p.depth[4], 1.2f);
  EXPECT_EQ(p.colors[8], k_red);  // 0.25 down: the top, 0.3 m down, at 1.2 m
  EXPECT_FLOAT_EQ(p.depth[8], 1.2f);
  EXPECT_EQ(p.colors[12], k_red);
  EXPECT_FLOAT_EQ(p.depth[12], 0.5);
}

TEST(Camera, StandingOnAPlateItSeesThePlate) {
  for (const bool fixed : {true, false}) {
    CameraScene scene(camera(k_square));
    const Solid plate{{test::box_ring(4, 4)}, {0, 0.01}};
    const TypeId type = fixed ? scene.type("plate", {plate}) : scene.robot("plate", {plate});
    scene.spec.bodies[scene.body("plate", type).index()].color = {0, 1, 0, 1};
    const Picture p(scene);
    EXPECT_EQ(p.colors[12], k_green) << fixed;
    EXPECT_FLOAT_EQ(p.depth[12], static_cast<float>(0.49 / 0.75));
    EXPECT_EQ(p.colors[8], k_green);  // 0.25 down: at 1.96 m, before its edge at 2 m
    EXPECT_FLOAT_EQ(p.depth[8], static_cast<float>(0.49 / 0.25));
  }
}

TEST(Camera, StaticPlatesWithDistantEdgesAreSeenWhateverTheTiles) {
  const Solid plate{{test::box_ring(60, 60)}, {0, 0.01}};
  const Params near{{"range_near", 0.1}, {"range_far", 1.2}};
  CameraScene level(camera(k_square, near));
  level.block({1, 0, 0, 1}, {0, 0, 0.9, 0}, plate);  // above the camera
  level.block({0, 1, 0, 1}, {10, 0, 0, 0}, plate);
  level.block({1, 0, 0, 1}, {}, {{test::box_ring(60, 60), test::box_ring(50, 50)}, {0, 0.2}});  // with a hole
  CameraScene down(camera(k_square, {{"range_near", 0.1}, {"range_far", 1.2}, {"tilt", -k_pi / 2}}));
  down.block({1, 0, 0, 1}, {0.4, 0, 0, 0}, box(0.4, 8, 0.1));
  down.block({0, 1, 0, 1}, {}, plate);
  down.block({1, 0, 0, 1}, {-0.4, 0, 0, 0}, box(0.4, 8, 0.1));
  for (CameraScene* scene : {&level, &down})
    for (engine::TypeSpec& type : scene->spec.types)
      if (!type.drive) type.parts[0].returns = {.obstacle = false, .ranger = -1};
  for (const double tile_size_m : {0.0, 0.4, 1.7, 6.0, 300.0}) {
    const engine::WorldOptions options{.threads = 1, .tile_size_m = tile_size_m};
    const Picture ahead(level, options);
    const Picture below(down, options);
    for (std::size_t column = 0; column < 4; ++column) {
      EXPECT_EQ(ahead.colors[column], k_red) << tile_size_m;
      EXPECT_FLOAT_EQ(ahead.depth[column], static_cast<float>(0.4 / 0.75));
      EXPECT_EQ(ahead.colors[4 + column], k_sky);
      EXPECT_EQ(ahead.colors[8 + column], k_sky);
      EXPECT_EQ(ahead.colors[12 + column], k_green) << tile_size_m;
      EXPECT_FLOAT_EQ(ahead.depth[12 + column], static_cast<float>(0.49 / 0.75));
      for (const std::size_t row : {0, 3}) {  // 0.3 m from the middle: on the boxes
        EXPECT_EQ(below.colors[4 * row + column], k_red);
        EXPECT_FLOAT_EQ(below.depth[4 * row + column], 0.4f);
      }
      for (const std::size_t row : {1, 2}) {
        EXPECT_EQ(below.colors[4 * row + column], k_green) << tile_size_m;
        EXPECT_FLOAT_EQ(below.depth[4 * row + column], 0.49f);
      }
    }
  }
}

TEST(Camera, DepthIsAlongTheAxisAndLeftIsLeft) {
  CameraScene scene(camera(k_square));
  scene.block({1, 0, 0, 1}, {3, 1.6, 0, 0}, box(0.1, 3, 2));
  scene.block({0, 1, 0, 1}, {3, -1.6, 0, 0}, box(0.1, 3, 2));
  const Picture p(scene);
  EXPECT_EQ(p.colors[4], k_red);
  EXPECT_EQ(p.colors[7], k_green);
  for (std::size_t column = 0; column < 4; ++column) EXPECT_FLOAT_EQ(p.depth[4 + column], 2.95f);
}

TEST(Camera, WhatIsNearIsCutAwayAndWhatIsFarIsSky) {
  CameraScene scene(camera(k_square, {{"range_near", 1.0}, {"range_far", 3.0}}));
  scene.block({1, 0, 0, 1}, {0.8, 0, 0, 0}, box(0.1, 4, 2));
  scene.block({0, 1, 0, 1}, {4, 0, 0, 0}, box(0.1, 40, 2));
  const Picture p(scene);
  EXPECT_EQ(p.colors[5], k_sky);
  EXPECT_EQ(p.depth[5], 3);
}

TEST(Camera, PanTurnsRightAndTiltTurnsUp) {
  CameraScene right(camera(k_square, {{"pan", k_pi / 2}}));
  right.block({1, 0, 0, 1}, {0, -2, 0, 0}, box(10, 0.2, 2));
  EXPECT_EQ(Picture(right).colors[5], k_red);
  CameraScene down(camera(k_square, {{"tilt", -k_pi / 2}}), {0, 0, 0.5, 0});
  const Picture floor(down);
  for (const float depth : floor.depth) EXPECT_NEAR(depth, 1, 1e-6);
  for (const int color : floor.colors) EXPECT_EQ(color, k_floor);
}

/// A point-by-point oracle: marches along the ray of each pixel in small steps through even-odd regions.
TEST(Camera, IsTrueToAMarchThroughSolids) {
  constexpr int k_worlds = test::k_slow_build ? 1 : 6;
  constexpr std::size_t k_pixels = 8;
  constexpr double k_step = 0.004;
  int compared = 0;
  int differ = 0;
  for (int w = 0; w < k_worlds; ++w) {
    Random random(5, 0, static_cast<std::uint32_t>(w), 0);
    const double tilt = w % 2 == 0 ? 0.0 : random.uniform(-0.5, 0.3);
    const Pose pose{random.uniform(-1, 1), random.uniform(-1, 1), 0, random.uniform(-3, 3)};
    CameraScene scene(camera({{"width", static_cast<int>(k_pixels)},
                              {"height", static_cast<int>(k_pixels)},
                              {"range_far", 5.0},
                              {"tilt", tilt}}),
                      pose);
    std::vector<Solid> solids;
    for (int b = 0; b < 14; ++b) {
      std::string name = "b";
      name += std::to_string(b);
      const double bottom = random.below(3) == 0 ? random.uniform(0, 0.8) : 0;
      const Solid solid{{test::box_ring(random.uniform(0.2, 1.5), random.uniform(0.2, 1.5))},
                        {bottom, bottom + random.uniform(0.1, 0.9)}};
      const double angle = random.uniform(-3.1, 3.1);
      const double away = random.uniform(1.4, 4);
      const Pose place{pose.x + away * std::cos(angle), pose.y + away * std::sin(angle), 0,
                       random.uniform(-3, 3)};
      scene.body(name, b % 2 == 0 ? scene.robot(name, {solid}) : scene.type(name, {solid}), place);
      solids.push_back(placed(solid, place));
    }
    const Picture picture(scene);
    const double half_width = std::tan(radians(35));
    const double half_height = std::tan(radians(20));
    for (std::size_t row = 0; row < k_pixels; ++row)
      for (std::size_t column = 0; column < k_pixels; ++column) {
        const double u = half_width * ((static_cast<double>(column) + 0.5) / k_pixels * 2 - 1);
        const double v = half_height * (1 - (static_cast<double>(row) + 0.5) / k_pixels * 2);
        const double ahead = std::cos(tilt) - v * std::sin(tilt);
        const double rise = std::sin(tilt) + v * std::cos(tilt);
        double depth = 5;
        for (double t = 0.2; t < depth; t += k_step) {
          const Vec2 at = pose.position() + Rotation(pose.heading) * Vec2(t * ahead, -t * u);
          const double z = k_eye + t * rise;
          bool inside = z <= 0;
          for (const Solid& solid : solids) inside = inside || (solid.z.contains(z) && contains(solid, at));
          if (inside) depth = t;
        }
        ++compared;
        differ += std::abs(picture.depth[row * k_pixels + column] - depth) > 2 * k_step;
      }
  }
  EXPECT_LE(differ, compared / 100) << "of " << compared;  // a step may leap over a corner
}

TEST(Camera, WhatCanSeeNothingIsRefused) {
  EXPECT_THAT(
      test::message_of<InputError>([&] {
        static_cast<void>(CameraScene(camera(k_square, {{"range_near", 3.0}, {"range_far", 2.0}})).world());
      }),
      ::testing::HasSubstr(
          "device \"camera\" has a range_near of 3 m, which must be below its range_far of 2 m"));
}

TEST(Camera, TheSameForAnyThreadsAndTiles) {
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.3, 0.3, 0.4)});
  scene[type].devices = {{.name = "camera",
                          .kind = "camera",
                          .params = camera({{"width", 12}, {"height", 8}}),
                          .pose_body_device = {0, 0, 0.3, 0},
                          .where = {}}};
  for (int i = 0; i < 20; ++i) {
    std::string name = "r";
    name += std::to_string(i);
    scene.body(name, type, {0.7 * (i % 5), 0.7 * (i / 5), 0, 0.37 * i});
  }
  scene.wall(-2, -2, -1.9, 4);
  const auto hash = [&](engine::WorldOptions options) {
    World world = scene.world(options);
    world.step();
    return world.hashes().state;
  };
  const std::uint64_t expected = hash({.threads = 1});
  EXPECT_EQ(hash({.threads = 3, .tile_size_m = 1.7}), expected);
  EXPECT_EQ(hash({.threads = 2, .tile_size_m = 45}), expected);
}

}  // namespace
}  // namespace troupe::sensors::camera_test
