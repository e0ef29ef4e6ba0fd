// The scenes that show one sensor each, with results that were computed by hand from the files.

#include "engine/world/world.hpp"
#include "sensors/blobfinder.hpp"
#include "sensors/bumper.hpp"
#include "sensors/camera.hpp"
#include "sensors/fiducial.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/troupe.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <vector>

namespace troupe::sensor_scenes_test {
namespace {

using ::testing::ElementsAre;

/// The robot "r0" of a scene, and what its devices read.
class Scene {
 public:
  explicit Scene(const char* file)
      : simulation_(test::source_dir() / "worlds" / file, {.threads = 1}),
        row_(world().view().row(world().state().names.find("r0"))) {}

  const engine::World& world() const { return simulation_.world(); }
  /// Steps until so many ticks are done.
  void run_to(std::uint64_t tick) {
    while (simulation_.tick() < tick) simulation_.step();
  }
  template <class T>
  std::vector<T> read(std::size_t field, std::size_t device = 0) const {
    const auto cell = world().tables()[world().view().type(row_).devices[device].table].cell<T>(
        world().view().slot(row_), field);
    return {cell.begin(), cell.end()};
  }
  /// The first `count` entries.
  template <class T>
  std::vector<T> read_first(std::size_t count, std::size_t field) const {
    std::vector<T> all = read<T>(field);
    all.resize(count);
    return all;
  }

 private:
  Simulation simulation_;
  Row row_;
};

// The robot is at x = -4 in the first tick; 0.5 m/s move it from the second on: tick k sees it at
// -4 + 0.05 (k - 2).
TEST(SensorScenes, FiducialReadsThePostsInSight) {
  Scene scene("fiducial.world");
  const auto ids = [&] {
    const auto count = scene.read<std::uint32_t>(sensors::k_fiducial_count)[0];
    return scene.read_first<std::int32_t>(count, sensors::k_fiducial_id);
  };
  scene.run_to(1);
  EXPECT_THAT(ids(), ElementsAre(1, 0));  // the second post is seen past the curtain, too far to be read
  const auto ranges = scene.read<float>(sensors::k_fiducial_range);
  EXPECT_NEAR(ranges[0], std::hypot(1, 1.5), 1e-6);
  EXPECT_NEAR(ranges[1], std::hypot(3, 1.5), 1e-6);
  EXPECT_NEAR(scene.read<float>(sensors::k_fiducial_bearing)[0], std::atan2(1.5, 1), 1e-6);
  scene.run_to(62);
  EXPECT_THAT(ids(), ElementsAre());  // at -1: beside the curtain; the low post and the other key never show
  scene.run_to(102);
  EXPECT_THAT(ids(), ElementsAre(0));  // at 1: the last post, 2.5 m away
  scene.run_to(122);
  EXPECT_THAT(ids(), ElementsAre(4));  // at 2
}

// 40 columns over 60 degrees are 60/39 degrees apart. The red crate's face, 1.9 m ahead, reaches 3.01 degrees
// to each side; the blue crate lies from 19.54 to 24.15 degrees.
TEST(SensorScenes, BlobsAreTheCratesOfTheColoursAskedFor) {
  Scene scene("blobs.world");
  scene.run_to(1);
  ASSERT_EQ(scene.read<std::uint32_t>(sensors::k_blob_count)[0], 2u);
  EXPECT_THAT(scene.read_first<std::int32_t>(2, sensors::k_blob_left), ElementsAre(18, 4));
  EXPECT_THAT(scene.read_first<std::int32_t>(2, sensors::k_blob_right), ElementsAre(21, 6));
  EXPECT_THAT(scene.read_first<std::int32_t>(2, sensors::k_blob_top), ElementsAre(8, 9));
  EXPECT_THAT(scene.read_first<std::int32_t>(2, sensors::k_blob_bottom), ElementsAre(12, 11));
  EXPECT_NEAR(scene.read<float>(sensors::k_blob_range)[0], 1.901, 5e-4);
  EXPECT_NEAR(scene.read<float>(sensors::k_blob_range)[1], 3.136, 5e-4);
  EXPECT_THAT(scene.read_first<std::uint8_t>(8, sensors::k_blob_color),
              ElementsAre(255, 0, 0, 255, 0, 0, 255, 255));
}

// 0.05 m a tick from the second on; the front, 0.2 m ahead, may not pass the post's face at 1.01 m. So it
// stands at 0.8 m after tick 17, which tick 18 is the first to see; the strips, 0.21 m ahead, were 5 cm away
// before.
TEST(SensorScenes, TheLeftBumperFeelsThePost) {
  Scene scene("bumper.world");
  scene.run_to(17);
  EXPECT_THAT(scene.read<std::uint8_t>(sensors::k_bumper_hit), ElementsAre(0, 0));
  for (const std::uint64_t tick : {18u, 19u, 40u}) {
    scene.run_to(tick);
    EXPECT_THAT(scene.read<std::uint8_t>(sensors::k_bumper_hit), ElementsAre(1, 0)) << tick;
    EXPECT_THAT(scene.read<std::uint32_t>(sensors::k_bumper_body),
                ElementsAre(scene.world().state().names.find("post").value, 0u));
  }
  EXPECT_NEAR(scene.world().view().poses()[scene.world().view().row(BodyId(1)).index()].x, 0.8, 1e-9);
}

// The eye is 0.3 m above the ground; at depth 1 the picture reaches 1 m to each side and 0.75 m up and down,
// so that pixel (c, r) looks (2 c - 39) / 40 m to the right and (29 - 2 r) / 40 m up.
TEST(SensorScenes, TheCameraSeesCratePlateAndGate) {
  Scene scene("camera.world");
  scene.run_to(1);
  const auto colors = scene.read<std::uint8_t>(sensors::k_camera_color);
  const auto depths = scene.read<float>(sensors::k_camera_depth);
  ASSERT_EQ(depths.size(), 40u * 30u);
  constexpr int k_red = 0xff0000, k_green = 0x00ff00, k_blue = 0x0000ff, k_wheat = 0xf5deb3;
  constexpr int k_floor = 0xcccccc, k_sky = 0x87ceeb;
  const auto expect = [&](std::size_t column, std::size_t row, int color, double depth) {
    const std::size_t i = row * 40 + column;
    EXPECT_EQ(colors[4 * i] << 16 | colors[4 * i + 1] << 8 | colors[4 * i + 2], color)
        << column << ", " << row;
    EXPECT_EQ(colors[4 * i + 3], 255);
    EXPECT_NEAR(depths[i], depth, 1e-4) << column << ", " << row;
  };
  // The crate's face, 2 m ahead, lies 0.25 to 0.65 to the left at depth 1, from 0.15 below to 0.15 above.
  expect(7, 12, k_red, 2);
  expect(14, 17, k_red, 2);
  expect(10, 14, k_red, 2);
  expect(6, 14, k_sky, 8);
  expect(10, 11, k_sky, 8);
  expect(15, 14, k_red, 0.5 / 0.225);  // its side
  expect(16, 14, k_sky, 8);
  // The plate is lower than the eye: its face 1.25 m ahead, then its top, 0.2 m down.
  expect(30, 18, k_blue, 1.25);
  expect(30, 17, k_blue, 0.2 / 0.125);
  expect(30, 16, k_floor, 0.3 / 0.075);
  // The gate: 2.9 m ahead, the bar from 0.5 to 0.7 m above the eye, 1 m to each side, then a post.
  expect(20, 10, k_green, 2.9);
  expect(20, 11, k_green, 2.9);
  expect(20, 12, k_sky, 8);
  expect(13, 10, k_green, 2.9);
  expect(12, 10, k_wheat, 2.9);
  // What is left: the floor, which ends at 8 m, and the sky.
  expect(20, 29, k_floor, 0.3 / 0.725);
  expect(20, 16, k_floor, 4);
  expect(20, 15, k_sky, 8);
  expect(20, 3, k_sky, 8);
}

TEST(SensorScenes, NoiseAndASonarsCone) {
  Scene scene("noise.world");
  const std::uint64_t ticks = test::k_slow_build ? 40 : 200;
  double sum = 0;
  double squares = 0;
  for (std::uint64_t tick = 1; tick <= ticks; ++tick) {
    scene.run_to(tick);
    EXPECT_FLOAT_EQ(scene.read<float>(0, 0)[0], 3.9f);
    EXPECT_FLOAT_EQ(scene.read<float>(0, 2)[0], static_cast<float>(std::hypot(1.9, 0.3)));
    const double error = scene.read<float>(0, 1)[0] - 3.9;
    sum += error;
    squares += error * error;
  }
  const auto count = static_cast<double>(ticks);
  EXPECT_NEAR(sum / count, 0, 4 * 0.1 / std::sqrt(count));
  EXPECT_NEAR(std::sqrt(squares / count), 0.1, 3 * 0.1 / std::sqrt(2 * count));
}

TEST(SensorScenes, TheLookoutIsTheSameForAnyThreadsAndTiles) {
  const auto hash = [](unsigned threads, double tile) {
    Simulation simulation(test::source_dir() / "worlds" / "lookout.json",
                          {.threads = threads, .tile_size_m = tile});
    simulation.run_for(test::k_slow_build ? 0.2 : 2);
    return simulation.state_hash();
  };
  const std::uint64_t expected = hash(1, 0);
  EXPECT_EQ(hash(3, 1.7), expected);
  EXPECT_EQ(hash(2, 45.1), expected);
}

}  // namespace
}  // namespace troupe::sensor_scenes_test
