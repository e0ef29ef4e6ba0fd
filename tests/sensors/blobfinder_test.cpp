#include "sensors/blobfinder.hpp"

#include "tests/support/scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace troupe::sensors::blobfinder_test {
namespace {

using engine::World;
using test::box;
using test::SceneBuilder;
using ::testing::ElementsAre;
using Params = std::initializer_list<std::pair<std::string_view, engine::Value>>;

const Color k_red{1, 0, 0, 1};
const Color k_green{0, 1, 0, 1};
const Color k_blue{0, 0, 1, 1};

/// A robot at the origin that looks along +x, and what the test adds.
struct BlobScene : SceneBuilder {
  explicit BlobScene(Params params) {
    const TypeId type = robot("robot", {box(0.2, 0.2)});
    (*this)[type].devices = {{.name = "finder",
                              .kind = "blobfinder",
                              .params = test::record(test::registry().device("blobfinder")->params, params),
                              .where = {}}};
    body("r", type);
  }
  void crate(const Color& color, double x, double y, double size = 0.2, engine::Returns returns = {}) {
    const std::string name = "crate" + std::to_string(spec.bodies.size());
    spec.bodies[body(name, type(name, {box(size, size)}, returns), {x, y, 0, 0}).index()].color = color;
  }
};

struct Blob {
  int left, right, top, bottom;
  float range;
  int color;  ///< 0xRRGGBB
};

std::vector<Blob> blobs(const BlobScene& scene) {
  World world = scene.world();
  world.step();
  const Row row = world.view().row(BodyId(1));
  const std::size_t slot = world.view().slot(row);
  const engine::StateTable& table = world.tables()[world.view().type(row).devices[0].table];
  const auto at = [&](std::size_t field, std::size_t i) { return table.cell<std::int32_t>(slot, field)[i]; };
  std::vector<Blob> out;
  for (std::size_t i = 0; i < table.cell<std::uint32_t>(slot, k_blob_count)[0]; ++i) {
    const auto color = table.cell<std::uint8_t>(slot, k_blob_color).subspan(4 * i, 4);
    out.push_back({at(k_blob_left, i), at(k_blob_right, i), at(k_blob_top, i), at(k_blob_bottom, i),
                   table.cell<float>(slot, k_blob_range)[i], color[0] << 16 | color[1] << 8 | color[2]});
  }
  return out;
}

TEST(Conformance12, ARedBoxTwoMetresAhead) {
  BlobScene scene({{"image_width", 40}, {"image_height", 20}, {"fov", radians(60)}});
  scene.crate(k_red, 2, 0);
  const std::vector<Blob> seen = blobs(scene);
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].left, 18);
  EXPECT_EQ(seen[0].right, 21);
  EXPECT_EQ(seen[0].top, 8);
  EXPECT_EQ(seen[0].bottom, 12);
  EXPECT_NEAR(seen[0].range, 1.901, 5e-4);
  EXPECT_EQ(seen[0].color, 0xff0000);
}

TEST(Blobfinder, NoColumnIsLostBetweenTwoBlobs) {
  BlobScene scene({{"image_width", 41}, {"fov", radians(90)}, {"range", 5.0}});
  scene.crate(k_green, 4, 1.9995, 4);  // fills the left half, and the column straight ahead
  scene.crate(k_blue, 4, -2.002, 4);
  const std::vector<Blob> seen = blobs(scene);
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[0].color, 0x0000ff);  // from right to left
  EXPECT_EQ(seen[1].color, 0x00ff00);
  EXPECT_EQ(seen[0].right, 40);
  EXPECT_EQ(seen[0].left, seen[1].right + 1);
  EXPECT_EQ(seen[1].left, 0);
}

TEST(Blobfinder, ReportsTheColoursItIsAskedForOnly) {
  const std::vector<double> red_and_blue{1, 0, 0, 0, 0, 1};
  BlobScene scene({{"colors", red_and_blue}});
  scene.crate(k_red, 2, 0.8);
  scene.crate(k_green, 2, 0);
  scene.crate(k_blue, 2, -0.8);
  const std::vector<Blob> seen = blobs(scene);
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[0].color, 0x0000ff);
  EXPECT_EQ(seen[1].color, 0xff0000);
}

TEST(Blobfinder, WhatHasNoBlobReturnHidesAndIsNoBlob) {
  for (const bool use : {true, false}) {
    BlobScene scene({{"use_blob_return", use}});
    scene.crate(k_red, 3, 0);
    scene.crate(k_green, 2, 0, 1, {.ranger = -1, .blob = false});
    const std::vector<Blob> seen = blobs(scene);
    ASSERT_EQ(seen.size(), use ? 0u : 1u);
    if (!use) {
      EXPECT_EQ(seen[0].color, 0x00ff00);
    }
  }
}

TEST(Blobfinder, SeesBodiesOfAnyHeightAndPansToTheLeft) {
  BlobScene scene({{"pan", radians(90)}, {"image_width", 1}});
  const TypeId low = scene.type("low", {box(0.4, 0.4, 0.01)});
  scene.body("low", low, {0, 2, 0.7, 0});
  const std::vector<Blob> seen = blobs(scene);
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_FLOAT_EQ(seen[0].range, 1.8f);
  EXPECT_EQ(seen[0].left, 0);
  EXPECT_EQ(seen[0].right, 0);
}

TEST(Blobfinder, CountsWhatItHasNoEntryFor) {
  BlobScene scene({{"most_blobs", 1}, {"fov", radians(90)}});
  scene.crate(k_red, 2, 0.8);
  scene.crate(k_blue, 2, -0.8);
  World world = scene.world();
  world.step();
  const Row row = world.view().row(BodyId(1));
  const engine::StateTable& table = world.tables()[world.view().type(row).devices[0].table];
  EXPECT_EQ(table.cell<std::uint32_t>(world.view().slot(row), k_blob_count)[0], 2u);
  EXPECT_THAT(table.cell<std::uint8_t>(world.view().slot(row), k_blob_color), ElementsAre(0, 0, 255, 255));
}

TEST(Blobfinder, ColoursThatDifferInOneChannelAreTwoBlobs) {
  const std::vector<Color> others{{0.75f, 0.5f, 0.5f, 1}, {0.5f, 0.75f, 0.5f, 1}, {0.5f, 0.5f, 0.75f, 1}};
  for (const Color& other : others) {
    BlobScene scene({{"fov", radians(40)}, {"image_width", 40}});
    scene.crate({0.5f, 0.5f, 0.5f, 1}, 3, 1, 2);  // the two crates fill the image, each one half of it
    scene.crate(other, 3, -1, 2);
    const std::vector<Blob> seen = blobs(scene);
    ASSERT_EQ(seen.size(), 2u);
    EXPECT_EQ(seen[0].left, 20);
    EXPECT_EQ(seen[1].right, 19);
  }
  BlobScene same({{"fov", radians(40)}, {"image_width", 40}});
  same.crate({0.5f, 0.5f, 0.5f, 1}, 3, 1, 2);
  same.crate({0.5f, 0.5f, 0.5f, 0.25f}, 3, -1, 2);
  EXPECT_EQ(blobs(same).size(), 1u) << "opacity does not count";
}

TEST(Blobfinder, APartShowsItsOwnColour) {
  BlobScene scene({{"image_width", 1}});
  const TypeId type = scene.type("post", {box(0.1, 0.1)});
  scene[type].parts.push_back({.name = "coat", .kind = "model", .solids = {box(0.4, 0.4)}});
  scene[type].parts.back().color = k_green;
  scene.spec.bodies[scene.body("post", type, {2, 0, 0, 0}).index()].color = k_red;
  const std::vector<Blob> seen = blobs(scene);
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].color, 0x00ff00);
}

TEST(Blobfinder, AnOddColumnLooksAlongTheAxisAndRowsEndWithTheImage) {
  BlobScene scene({{"image_width", 1}, {"image_height", 10}, {"fov", radians(60)}});
  scene.crate(k_red, 0.6, 0, 1);  // its face is 0.1 m ahead: 0.3 m are 71.6 degrees, 11.9 rows of 6 degrees
  const std::vector<Blob> seen = blobs(scene);
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_FLOAT_EQ(seen[0].range, 0.1f);
  EXPECT_EQ(seen[0].top, 0);
  EXPECT_EQ(seen[0].bottom, 10);
}

TEST(Blobfinder, EntriesAfterTheLastBlobAreZero) {
  BlobScene scene({{"most_blobs", 2}, {"fov", radians(90)}});
  scene.crate(k_red, 2, 0.8);
  const BodyId crate = scene.body("crate", scene.robot("crate", {box(0.2, 0.2)}), {2, -0.8, 0, 0});
  scene.spec.bodies[crate.index()].color = k_blue;
  World world = scene.world();
  world.step();
  const Row row = world.view().row(BodyId(1));
  const std::size_t slot = world.view().slot(row);
  const engine::StateTable& table = world.tables()[world.view().type(row).devices[0].table];
  ASSERT_EQ(table.cell<std::uint32_t>(slot, k_blob_count)[0], 2u);
  world.set_poses(std::vector<World::Placed>{{world.view().row(crate), {-2, 0, 0, 0}}});
  world.step();
  ASSERT_EQ(table.cell<std::uint32_t>(slot, k_blob_count)[0], 1u);
  for (const std::size_t field : {k_blob_left, k_blob_right, k_blob_top, k_blob_bottom})
    EXPECT_EQ(table.cell<std::int32_t>(slot, field)[1], 0) << field;
  EXPECT_EQ(table.cell<float>(slot, k_blob_range)[1], 0);
  EXPECT_THAT(table.cell<std::uint8_t>(slot, k_blob_color), ElementsAre(255, 0, 0, 255, 0, 0, 0, 0));
}

}  // namespace
}  // namespace troupe::sensors::blobfinder_test
