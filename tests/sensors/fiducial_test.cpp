#include "sensors/fiducial.hpp"

#include "base/random.hpp"
#include "tests/support/scene.hpp"
#include "tests/support/slow_build.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace troupe::sensors::fiducial_test {
namespace {

using engine::World;
using test::box;
using test::SceneBuilder;
using ::testing::ElementsAre;
using Params = std::initializer_list<std::pair<std::string_view, engine::Value>>;

constexpr double k_eye = 0.3;  // m: height of the finder

engine::DeviceSpec finder(Params params = {}) {
  return {.name = "finder",
          .kind = "fiducial",
          .params = test::record(test::registry().device("fiducial")->params, params),
          .pose_body_device = {0, 0, k_eye, 0},
          .where = {}};
}

/// A robot at the origin that looks along +x, and what the test adds.
struct FinderScene : SceneBuilder {
  explicit FinderScene(Params params = {}, const Pose& pose = {}) {
    const TypeId type = robot("robot", {box(0.2, 0.2)});
    (*this)[type].devices = {finder(params)};
    body("r", type, pose);
  }
  BodyId target(std::int32_t id, const Pose& pose, double height = 1, std::int32_t key = 0) {
    const std::string name = "target" + std::to_string(spec.bodies.size());
    return body(name, type(name, {box(0.2, 0.2, height)}, {.fiducial = id, .fiducial_key = key}), pose);
  }
};

/// What the finder of body 1 reads after a tick.
struct Seen {
  explicit Seen(const SceneBuilder& scene) : world(scene.world()) {
    world.step();
    const Row row = world.view().row(BodyId(1));
    slot = world.view().slot(row);
    table = &world.tables()[world.view().type(row).devices[0].table];
  }
  template <class T>
  std::span<const T> field(std::size_t f) const {
    return table->cell<T>(slot, f);
  }
  std::uint32_t count() const { return field<std::uint32_t>(k_fiducial_count)[0]; }
  std::vector<std::int32_t> ids() const {
    const auto all = field<std::int32_t>(k_fiducial_id);
    return {all.begin(),
            all.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(count(), all.size()))};
  }
  World world;
  std::size_t slot = 0;
  const engine::StateTable* table = nullptr;
};

std::vector<std::int32_t> ids(const SceneBuilder& scene) { return Seen(scene).ids(); }

TEST(Conformance11, ATargetTwoMetresAhead) {
  FinderScene scene;
  scene.target(7, {2, 0, 0, 0.5});
  const Seen seen(scene);
  EXPECT_EQ(seen.count(), 1u);
  EXPECT_EQ(seen.field<std::int32_t>(k_fiducial_id)[0], 7);
  EXPECT_EQ(seen.field<std::uint32_t>(k_fiducial_body)[0], 2u);
  EXPECT_FLOAT_EQ(seen.field<float>(k_fiducial_range)[0], 2);
  EXPECT_FLOAT_EQ(seen.field<float>(k_fiducial_bearing)[0], 0);
  EXPECT_FLOAT_EQ(seen.field<float>(k_fiducial_heading)[0], 0.5);
  const auto pose = seen.field<double>(k_fiducial_pose);
  EXPECT_THAT(std::vector(pose.begin(), pose.begin() + 4), ElementsAre(2, 0, 0, 0.5));
}

TEST(Conformance11, AnotherKeyHides) {
  FinderScene scene;
  scene.target(7, {2, 0, 0, 0}, 1, 3);
  EXPECT_THAT(ids(scene), ElementsAre());
  FinderScene with_key({{"key", 3}});
  with_key.target(7, {2, 0, 0, 0}, 1, 3);
  EXPECT_THAT(ids(with_key), ElementsAre(7));
}

TEST(Conformance11, ABodyThatRangersSeeThroughHides) {
  FinderScene scene;
  scene.target(7, {2, 0, 0, 0});
  EXPECT_THAT(ids(scene), ElementsAre(7));
  scene.wall(1, -1, 1.1, 1, {.obstacle = false, .ranger = -1});
  EXPECT_THAT(ids(scene), ElementsAre());
}

TEST(Conformance11, ALowTargetIsSeenWithIgnoreZlocOnly) {
  const auto low = [](bool ignore_zloc) {
    FinderScene scene({{"ignore_zloc", ignore_zloc}});
    scene.target(7, {2, 0, 0, 0}, 0.1);
    return scene;
  };
  EXPECT_THAT(ids(low(false)), ElementsAre());
  EXPECT_THAT(ids(low(true)), ElementsAre(7));
  FinderScene before = low(true);
  before.wall(1, -1, 1.1, 1);
  EXPECT_THAT(ids(before), ElementsAre());
  FinderScene behind = low(true);  // hides it in Stage
  behind.wall(3, -1, 3.1, 1);
  EXPECT_THAT(ids(behind), ElementsAre(7));
  FinderScene beside = low(true);  // at the distance of its origin, which is not nearer
  beside.wall(2, -1, 2.1, 1);
  EXPECT_THAT(ids(beside), ElementsAre(7));
}

TEST(Fiducial, BodiesOfOneTypeMayHaveNumbersOfTheirOwn) {
  for (const bool fixed : {true, false}) {
    FinderScene scene;
    const TypeId type =
        fixed ? scene.type("target", {box(0.2, 0.2)}) : scene.robot("target", {box(0.2, 0.2)});
    scene[type].parts[0].returns.fiducial = 1;
    scene.spec.bodies[scene.body("a", type, {2, 1, 0, 0}).index()].fiducial = 5;
    scene.spec.bodies[scene.body("b", type, {3, 0, 0, 0}).index()].fiducial = -6;
    scene.body("c", type, {3.5, -1, 0, 0});
    EXPECT_THAT(ids(scene), ElementsAre(5, -6, 1)) << fixed;
  }
}

TEST(Fiducial, LimitsOfRangeAndFieldOfView) {
  FinderScene scene({{"range_max", 4.0}, {"range_max_id", 2.0}, {"fov", radians(90)}});
  scene.target(1, {0, 1.5, 0, 0});  // beside
  scene.target(2, {1, 0.9, 0, 0});
  scene.target(3, {3, 0, 0, 0});  // too far to be read
  scene.target(4, {4, 1, 0, 0});  // too far
  const Seen seen(scene);
  EXPECT_THAT(seen.ids(), ElementsAre(2, 0));
  EXPECT_EQ(seen.field<std::uint32_t>(k_fiducial_body)[1], 4u);
  EXPECT_NEAR(seen.field<float>(k_fiducial_bearing)[0], std::atan2(0.9, 1), 1e-6);
}

TEST(Fiducial, TheLeastRangeIsAppliedOnlyWhereAsked) {
  for (const bool apply : {false, true}) {
    FinderScene scene({{"range_min", 1.0}, {"apply_range_min", apply}});
    scene.target(5, {0.5, 0, 0, 0});
    EXPECT_EQ(Seen(scene).count(), apply ? 0u : 1u);
  }
}

TEST(Fiducial, ALeastRangeThatHidesEverythingIsAnErrorIfItApplies) {
  FinderScene scene({{"range_min", 8.0}});
  scene.target(5, {0.5, 0, 0, 0});
  EXPECT_EQ(Seen(scene).count(), 1u);
  scene = FinderScene({{"range_min", 8.0}, {"apply_range_min", true}});
  EXPECT_EQ(scene.error(),
            "error: device \"finder\" has a range_min of 8 m, which must be below its range_max of 8 m, "
            "because apply_range_min is true");
}

TEST(Fiducial, TheNearestComeFirstAndAllAreCounted) {
  FinderScene scene({{"most_targets", 2}, {"fov", 2 * k_pi}});
  scene.target(1, {0, 3, 0, 0});
  scene.target(2, {1, 0, 0, 0});
  scene.target(3, {0, -2, 0, 0});
  scene.target(4, {-2, 0, 0, 0});
  const Seen seen(scene);
  EXPECT_EQ(seen.count(), 4u);
  EXPECT_THAT(seen.ids(), ElementsAre(2, 3));  // of two at one range the lower body
}

TEST(Fiducial, FindsRobotsByWhatTheyStandOnNotByWhatTheyCarry) {
  FinderScene scene;
  const TypeId other = scene.robot("other", {box(0.3, 0.3)});
  scene[other].parts[0].returns.fiducial = 9;
  scene.body("o", other, {3, 0, 0, 1});
  EXPECT_THAT(ids(scene), ElementsAre(9));
  // A screen of its own before the model: another model, that stops the ray, as in Stage.
  scene[other].parts.push_back({.name = "screen", .solids = {{{test::rectangle(-1, -1, 1, 1)}, {0, 1}}}});
  EXPECT_THAT(ids(scene), ElementsAre());
}

TEST(Fiducial, ReadsAreThoseOfItsOwnPose) {
  FinderScene scene({}, {1, 1, 0, k_pi / 2});
  scene.target(6, {1, 4, 0, 0});
  const Seen seen(scene);
  EXPECT_FLOAT_EQ(seen.field<float>(k_fiducial_range)[0], 3);
  EXPECT_NEAR(seen.field<float>(k_fiducial_bearing)[0], 0, 1e-7);
  EXPECT_FLOAT_EQ(seen.field<float>(k_fiducial_heading)[0], static_cast<float>(-k_pi / 2));
}

TEST(Fiducial, LimitsAreClosedOrOpenAsDocumented) {
  FinderScene scene({{"range_min", 1.0},
                     {"apply_range_min", true},
                     {"range_max", 4.0},
                     {"range_max_id", 2.0},
                     {"fov", k_pi}});
  scene.target(1, {4, 0, 0, 0});                        // at range_max: not found
  const BodyId beside = scene.target(2, {0, 1, 0, 0});  // at range_min, and at a bearing of fov/2: found
  const BodyId far = scene.target(3, {0, -2, 0, 0});    // at range_max_id: its number is not read
  const Seen seen(scene);
  EXPECT_EQ(seen.count(), 2u);
  EXPECT_THAT(seen.ids(), ElementsAre(2, 0));
  EXPECT_EQ(seen.field<std::uint32_t>(k_fiducial_body)[0], beside.value);
  EXPECT_EQ(seen.field<std::uint32_t>(k_fiducial_body)[1], far.value);
}

TEST(Fiducial, AnglesAreWithinHalfATurn) {
  // The finder looks to 3 rad, and the target is in the direction of -3 rad, which is its heading too.
  FinderScene scene({}, {0, 0, 0, 3});
  scene.target(6, {2 * std::cos(3), -2 * std::sin(3), 0, -3});
  const Seen seen(scene);
  ASSERT_EQ(seen.count(), 1u);
  EXPECT_NEAR(seen.field<float>(k_fiducial_bearing)[0], 2 * k_pi - 6, 1e-6);
  EXPECT_NEAR(seen.field<float>(k_fiducial_heading)[0], 2 * k_pi - 6, 1e-6);
}

TEST(Fiducial, ReadsSizeAndPoseOfTheModelThatIsMarked) {
  FinderScene scene;
  const TypeId type = scene.robot("truck", {box(0.2, 0.2, 0.1)});
  engine::PartSpec plate{.name = "plate", .kind = "model", .pose_body_part = {0.5, 0, 0.25, 1}};
  plate.size = {0.125, 0.25, 0.5};
  plate.solids = {placed(box(0.2, 0.2), {0.5, 0, 0, 0})};
  plate.returns.fiducial = 8;
  scene[type].parts.push_back(plate);
  scene.body("truck", type, {2, 0, 0.125, -0.25});
  const Seen seen(scene);
  ASSERT_THAT(seen.ids(), ElementsAre(8));
  const auto size = seen.field<float>(k_fiducial_size);
  EXPECT_THAT(std::vector(size.begin(), size.begin() + 3), ElementsAre(0.125f, 0.25f, 0.5f));
  const auto pose = seen.field<double>(k_fiducial_pose);
  EXPECT_NEAR(pose[0], 2 + 0.5 * std::cos(0.25), 1e-12);
  EXPECT_NEAR(pose[1], -0.5 * std::sin(0.25), 1e-12);
  EXPECT_DOUBLE_EQ(pose[2], 0.375);
  EXPECT_DOUBLE_EQ(pose[3], 0.75);
}

// The ray towards a model does not end at its origin, because its surface may be farther away.
TEST(Fiducial, AModelMayBeFarBehindItsOrigin) {
  FinderScene scene;
  const TypeId type = scene.robot("hook", {box(0.2, 0.2, 0.1)});
  scene[type].parts.push_back({.name = "plate", .kind = "model", .pose_body_part = {-1.5, 0, 0, 0}});
  scene[type].parts.back().solids = {placed(box(0.2, 0.2), {2, 0, 0, 0})};
  scene[type].parts.back().returns.fiducial = 8;
  scene.body("hook", type, {3, 0, 0, 0});
  const Seen seen(scene);
  ASSERT_THAT(seen.ids(), ElementsAre(8));
  EXPECT_FLOAT_EQ(seen.field<float>(k_fiducial_range)[0], 1.5f) << "that of the origin";
}

TEST(Fiducial, EntriesAfterTheLastTargetAreZero) {
  FinderScene scene;
  const TypeId type = scene.robot("other", {box(0.3, 0.3)});
  scene[type].parts[0].returns.fiducial = 9;
  scene.body("a", type, {1, 0.5, 0, 1});
  const BodyId second = scene.body("b", type, {2, -1, 0.25, 1});
  const engine::FieldTable& table = test::registry().device("fiducial")->params;
  scene[scene.spec.bodies[1].type].devices[0].params = test::record(table, {{"most_targets", 2}});
  Seen seen(scene);
  ASSERT_THAT(seen.ids(), ElementsAre(9, 9));
  seen.world.set_poses(std::vector<World::Placed>{{seen.world.view().row(second), {0, 9, 0, 0}}});
  seen.world.step();
  ASSERT_THAT(seen.ids(), ElementsAre(9));
  EXPECT_EQ(seen.field<std::int32_t>(k_fiducial_id)[1], 0);
  EXPECT_EQ(seen.field<std::uint32_t>(k_fiducial_body)[1], 0u);
  for (const std::size_t field : {k_fiducial_range, k_fiducial_bearing, k_fiducial_heading})
    EXPECT_EQ(seen.field<float>(field)[1], 0) << field;
  EXPECT_THAT(seen.field<float>(k_fiducial_size).subspan(3), ::testing::Each(0.0f));
  EXPECT_THAT(seen.field<double>(k_fiducial_pose).subspan(4), ::testing::Each(0.0));
}

/// In a crowd of finders that carry marks: a robot that sees another across nothing but air is seen by it.
TEST(Fiducial, SightIsMutualInACrowdForAnyThreadsAndTiles) {
  constexpr int k_robots = test::k_slow_build ? 12 : 60;
  SceneBuilder scene;
  const TypeId type = scene.robot("robot", {box(0.3, 0.3)});
  scene[type].parts[0].returns.fiducial = 1;
  scene[type].devices = {finder({{"fov", 2 * k_pi}, {"range_max", 5.0}, {"most_targets", 100}})};
  Random random(3, 0, 0, 0);
  for (int i = 0; i < k_robots; ++i) {
    std::string name = "r";
    name += std::to_string(i);
    scene.body(name, type,
               {1.0 * (i % 8) + random.uniform(0, 0.4), 1.0 * (i / 8) + random.uniform(0, 0.4), 0,
                random.uniform(-3, 3)});
  }
  const auto sees = [&](engine::WorldOptions options) {
    World world = scene.world(options);
    world.step();
    std::vector<std::vector<std::uint32_t>> out;
    for (std::size_t b = 1; b < scene.spec.bodies.size(); ++b) {
      const Row row = world.view().row(BodyId(b));
      const engine::StateTable& table = world.tables()[world.view().type(row).devices[0].table];
      const auto bodies = table.cell<std::uint32_t>(world.view().slot(row), k_fiducial_body);
      const auto count = table.cell<std::uint32_t>(world.view().slot(row), k_fiducial_count)[0];
      out.emplace_back(bodies.begin(), bodies.begin() + count);
    }
    return out;
  };
  const auto seen = sees({.threads = 1});
  EXPECT_EQ(seen, sees({.threads = 3, .tile_size_m = 1.7}));
  EXPECT_EQ(seen, sees({.threads = 2, .tile_size_m = 45}));
  std::size_t pairs = 0;
  for (std::uint32_t a = 0; a < seen.size(); ++a)
    for (const std::uint32_t b : seen[a]) {
      ++pairs;
      EXPECT_TRUE(std::ranges::count(seen[b - 1], a + 1) == 1) << a + 1 << " and " << b;
    }
  EXPECT_GT(pairs, 2u * k_robots);
}

}  // namespace
}  // namespace troupe::sensors::fiducial_test
