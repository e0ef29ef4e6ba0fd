#include "models/controllers/fiducial_readings.hpp"

#include "sensors/fiducial.hpp"
#include "tests/support/scene.hpp"

#include <gtest/gtest.h>

#include <string>

namespace troupe::models::fiducial_readings_test {
namespace {

TEST(FiducialReadings, AreThoseOfTheFinder) {
  test::SceneBuilder scene;
  const TypeId robot = scene.robot("robot", {test::box(0.2, 0.2)});
  scene[robot].devices = {
      {.name = "finder",
       .kind = "fiducial",
       .params = test::record(test::registry().device("fiducial")->params, {{"most_targets", 2}}),
       .pose_body_device = {0, 0, 0.5, 0}}};
  const BodyId body = scene.body("r", robot);
  for (int i = 1; i <= 3; ++i) {
    const std::string name = std::string("target").append(std::to_string(i));
    scene.body(name, scene.type(name, {test::box(0.2, 0.2)}, {.fiducial = 10 * i}),
               {1.0 * i, 1.5 - 0.5 * i, 0, 0.25 * i});
  }
  engine::World world = scene.world();
  world.step();
  const Row row = world.view().row(body);
  const engine::BodyType::Device& device = world.view().type(row).devices[0];
  const engine::Readings seen(world.tables()[device.table], world.view().slot(row));
  const engine::DeviceInfo info{"finder", "fiducial", device.prepared};
  const FiducialReadings readings(info);

  EXPECT_EQ(seen.field<std::uint32_t>(sensors::k_fiducial_count)[0], 3u);
  ASSERT_EQ(readings.count(seen), 2u) << "as many as there are entries";
  EXPECT_EQ(readings.id(seen, 0), 10);
  EXPECT_EQ(readings.id(seen, 1), 20);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(readings.range(seen, i), seen.field<float>(sensors::k_fiducial_range)[i]);
    EXPECT_EQ(readings.bearing(seen, i), seen.field<float>(sensors::k_fiducial_bearing)[i]);
    EXPECT_EQ(readings.heading(seen, i), seen.field<float>(sensors::k_fiducial_heading)[i]);
  }
  EXPECT_NEAR(readings.heading(seen, 1), 0.5, 1e-7);
  EXPECT_NEAR(readings.bearing(seen, 0), 0.7853982, 1e-7);
  EXPECT_EQ(readings.position(seen, 1), Vec2(2, 0.5));

  // Of a finder that is turned to the left on its robot: angles from where the robot looks.
  const FiducialReadings turned({"finder", "fiducial", device.prepared, {0, 0, 0, 3}});
  EXPECT_NEAR(turned.bearing(seen, 0), 3.7853982 - 2 * k_pi, 1e-6);
  EXPECT_NEAR(turned.heading(seen, 1), 3.5 - 2 * k_pi, 1e-6);
}

TEST(FiducialReadings, MarkedBodiesAreThereFromTheStartAndWhereTheirMarkIs) {
  test::SceneBuilder scene;
  const TypeId pad = scene.type("pad", {test::box(0.2, 0.2)}, {.fiducial = 2});
  const TypeId post = scene.type("post", {test::box(0.2, 0.2)}, {.fiducial = 3});
  scene[post].parts.push_back({.name = "plug", .pose_body_part = {2, 0, 0, 0}, .returns = {.fiducial = 2}});
  const BodyId whole = scene.body("whole", pad, {1, 5, 0, 0});
  const BodyId turned = scene.body("turned", post, {1, 1, 0, k_pi / 2});
  scene.spec.reserves = {{"late", BodyId(turned.value + 1), 1}};
  scene.body("late0", pad);
  const std::vector<MarkedBody> marked = bodies_with_mark(scene.spec, 2);
  ASSERT_EQ(marked.size(), 2u);
  EXPECT_EQ(marked[0].body, whole);
  EXPECT_EQ(marked[0].at, Vec2(1, 5));
  EXPECT_EQ(marked[1].body, turned);
  EXPECT_NEAR((marked[1].at - Vec2(1, 3)).norm(), 0, 1e-12);
  EXPECT_TRUE(bodies_with_mark(scene.spec, 4).empty());
}

}  // namespace
}  // namespace troupe::models::fiducial_readings_test
