#include "sensors/ranger_cone.hpp"

#include "base/random.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scene.hpp"
#include "tests/support/slow_build.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace troupe::sensors::ranger_noise_test {
namespace {

using engine::World;
using test::box;
using test::SceneBuilder;
using Params = std::initializer_list<std::pair<std::string_view, engine::Value>>;

/// A robot at the origin with one ranger of some equal transducers, 0.5 m high.
struct NoiseScene : SceneBuilder {
  explicit NoiseScene(Params params, int transducers = 1, bool intensity = false, const Pose& pose = {}) {
    const engine::FieldTable& table = test::registry().device("ranger")->params;
    engine::Record one = test::record(*table.fields[0].record, params);
    one[0] = std::vector<engine::Record>{{0.0, 0.0, 0.5, 0.0}};
    const std::vector<engine::Record> all(static_cast<std::size_t>(transducers), one);
    const TypeId type = robot("robot", {box(0.1, 0.1, 0.1)});
    (*this)[type].devices = {{.name = "ranger", .kind = "ranger", .params = {all, intensity}, .where = {}}};
    body("r", type, pose);
  }
};

std::vector<float> read(const World& world, std::size_t field = 0) {
  const Row row = world.view().row(BodyId(1));
  const auto cell =
      world.tables()[world.view().type(row).devices[0].table].cell<float>(world.view().slot(row), field);
  return {cell.begin(), cell.end()};
}

std::vector<float> readings(const SceneBuilder& scene, int ticks = 1) {
  World world = scene.world();
  std::vector<float> out;
  for (int t = 0; t < ticks; ++t) {
    world.step();
    const std::vector<float> now = read(world);
    out.insert(out.end(), now.begin(), now.end());
  }
  return out;
}

struct Spread {
  double mean = 0, deviation = 0, least = 1e9, most = -1e9;
};

Spread spread(const std::vector<float>& values) {
  Spread s;
  for (const double value : values) {
    s.mean += value / static_cast<double>(values.size());
    s.least = std::min(s.least, value);
    s.most = std::max(s.most, value);
  }
  for (const double value : values) s.deviation += (value - s.mean) * (value - s.mean);
  s.deviation = std::sqrt(s.deviation / static_cast<double>(values.size()));
  return s;
}

constexpr int k_ticks = test::k_slow_build ? 60 : 200;

TEST(Conformance10, NormalNoiseHasItsStandardDeviation) {
  NoiseScene scene({{"noise_stddev", 0.1}}, 40);
  scene.wall(3.94, -2, 4.2, 2);
  const Spread s = spread(readings(scene, k_ticks));
  EXPECT_NEAR(s.mean, 3.94, 0.006);
  EXPECT_NEAR(s.deviation, 0.1, 0.005);
}

TEST(RangerNoise, RelativeNoiseGrowsWithTheReading) {
  for (const double distance : {1.0, 4.0}) {
    NoiseScene scene({{"noise_relative", 0.05}}, 40);
    scene.wall(distance, -2, 4.2, 2);
    const Spread s = spread(readings(scene, k_ticks));
    EXPECT_NEAR(s.mean, distance, 0.003 * distance);
    EXPECT_NEAR(s.deviation, 0.05 * distance, 0.0025 * distance);
  }
}

TEST(Conformance10, ProportionalNoiseIsUniform) {
  NoiseScene scene({{"noise_proportional", 0.1}}, 40);
  scene.wall(3.94, -2, 4.2, 2);
  const Spread s = spread(readings(scene, k_ticks));
  EXPECT_NEAR(s.deviation, 0.394 / std::sqrt(3), 0.01);
  EXPECT_GE(s.least, 3.94f * 0.9f);
  EXPECT_LE(s.most, 3.94f * 1.1f);
  EXPECT_LT(s.least, 3.56);
  EXPECT_GT(s.most, 4.32);
}

TEST(Conformance10, WhereNothingIsMetThereIsNoNoise) {
  const NoiseScene scene({{"noise_stddev", 0.1}, {"noise_proportional", 0.1}, {"range_max", 3.7}}, 3);
  EXPECT_EQ(readings(scene, 3), std::vector<float>(9, 3.7f));
}

TEST(RangerNoise, StaysWithinZeroAndTheMaximum) {
  NoiseScene near({{"noise_stddev", 0.2}}, 40);
  near.wall(0.1, -2, 0.2, 2);
  EXPECT_EQ(spread(readings(near, 5)).least, 0);
  NoiseScene far({{"noise_stddev", 0.2}}, 40);
  far.wall(4.95, -2, 5.2, 2);
  EXPECT_EQ(spread(readings(far, 5)).most, 5);
}

TEST(RangerNoise, FollowsFromTheSeedAndFromNoNeighbour) {
  NoiseScene scene({{"noise_stddev", 0.1}}, 4);
  scene.wall(3, -2, 4.2, 2);
  const std::vector<float> first = readings(scene, 3);
  EXPECT_EQ(first, readings(scene, 3));
  EXPECT_NE(first[0], first[1]);
  EXPECT_NE(first[0], first[4]);
  NoiseScene with_others = scene;
  with_others.body("other", TypeId(with_others.spec.bodies[1].type), {0, 4, 0, 0});
  EXPECT_EQ(first, readings(with_others, 3));
  scene.spec.seed = 2;
  EXPECT_NE(first, readings(scene, 3));
}

TEST(RangerNoise, AngularNoiseTurnsTheBeams) {
  for (const auto ranging : {engine::RangingEngine::exact, engine::RangingEngine::grid}) {
    NoiseScene scene({{"noise_angular", 0.3}}, 40);
    scene.wall(2, -3, 2.2, 3);
    scene.spec.ranging = ranging;
    const double cell = ranging == engine::RangingEngine::grid ? 0.05 : 1e-6;
    const Spread s = spread(readings(scene, 5));
    EXPECT_NEAR(s.least, 2, 1e-3 + cell);
    EXPECT_LE(s.most, 2 / std::cos(0.3) + cell);
    EXPECT_GT(s.most, 2 / std::cos(0.28));
  }
}

TEST(RangerNoise, AScannerThatHardlyWobblesReadsWhatOneThatDoesNotReads) {
  const auto scanned = [](double noise) {
    NoiseScene scene({{"noise_angular", noise}, {"samples", 101}, {"fov", k_pi}}, 1);
    scene.wall(2, -3, 2.2, 3);
    scene.wall(-1, 1, 2, 1.5);
    return readings(scene);
  };
  const std::vector<float> steady = scanned(0);
  const std::vector<float> noisy = scanned(1e-9);
  ASSERT_EQ(steady.size(), noisy.size());
  for (std::size_t i = 0; i < steady.size(); ++i) EXPECT_NEAR(steady[i], noisy[i], 2e-5) << i;
}

TEST(Ranger, TheLeastRangeIsAppliedOnlyWhereAsked) {
  for (const bool apply : {false, true}) {
    NoiseScene scene({{"range_min", 0.5}, {"apply_range_min", apply}});
    scene.wall(0.3, -1, 0.4, 1);
    EXPECT_EQ(readings(scene)[0], apply ? 0.5f : 0.3f);
  }
}

TEST(Ranger, ALeastRangeAboveTheGreatestIsAnErrorIfItApplies) {
  NoiseScene scene({{"range_min", 3.0}, {"range_max", 2.0}});
  EXPECT_EQ(readings(scene)[0], 2.0f);
  scene = NoiseScene({{"range_min", 3.0}, {"range_max", 2.0}, {"apply_range_min", true}});
  Diagnostics diagnostics;
  EXPECT_EQ(
      test::message_of<InputError>([&] { const World world(scene.spec, test::registry(), {}, diagnostics); }),
      "error: device \"ranger\" has a range_min of 3 m in transducer 0 (counted from 0), which must "
      "be at most its range_max of 2 m, because apply_range_min is true");
}

// ---- beams with a width

const Vec2 k_right(std::cos(0.2), -std::sin(0.2));
const Vec2 k_left(std::cos(0.2), std::sin(0.2));

TEST(RangerCone, NearestPointOfAnEdge) {
  const auto nearest = [](Vec2 a, Vec2 b) { return nearest_in_cone(k_right, k_left, a, b); };
  EXPECT_DOUBLE_EQ(*nearest({2, -1}, {2, 1}), 2);                                     // its foot
  EXPECT_DOUBLE_EQ(*nearest({2, 0.1}, {3, 0.1}), std::hypot(2, 0.1));                 // an end
  EXPECT_NEAR(*nearest({2, 0}, {0, 2}), 2 / (std::cos(0.2) + std::sin(0.2)), 1e-12);  // where it leaves
  EXPECT_FALSE(nearest({2, 1}, {3, 1}));
  EXPECT_FALSE(nearest({-2, -1}, {-2, 1}));  // behind
  EXPECT_FALSE(nearest({2, -0.5}, {-1, 0.1}) > 1.9);
}

TEST(RangerCone, SeesWhatItsMiddleMisses) {
  NoiseScene scene({{"beam_width", 0.4}}, 1, true);
  scene.body("post", scene.type("post", {box(0.2, 0.2)}, {.ranger = 0.25f}), {2, 0.3, 0, 0});
  World world = scene.world();
  world.step();
  EXPECT_FLOAT_EQ(read(world)[0], static_cast<float>(std::hypot(1.9, 0.2)));
  EXPECT_EQ(read(world, 1)[0], 0.25f);
  NoiseScene narrow({}, 1, true);
  narrow.body("post", narrow.type("post", {box(0.2, 0.2)}), {2, 0.3, 0, 0});
  EXPECT_EQ(readings(narrow)[0], 5.0f);
}

/// 40 beams with angular noise, of which the last 20 have a width, and 10 with a width but without noise.
TEST(RangerCone, IsTurnedByAngularNoise) {
  const auto read_of = [](double width, engine::RangingEngine ranging) {
    engine::RangerParams params;
    for (int i = 0; i < 50; ++i)
      params.transducers.push_back(
          {.pose = {0, 0, 0.5, 0}, .noise_angular = i < 40 ? 0.5 : 0, .beam_width = i < 20 ? 0 : width});
    SceneBuilder scene;
    const TypeId type = scene.robot("robot", {box(0.1, 0.1, 0.1)});
    scene[type].devices = {
        {.name = "ranger", .kind = "ranger", .params = engine::to_record(params), .where = {}}};
    scene.body("r", type);
    scene.wall(2, -3, 2.2, 3);
    scene.spec.ranging = ranging;
    return readings(scene);
  };
  for (const auto ranging : {engine::RangingEngine::exact, engine::RangingEngine::grid}) {
    const double rounding = ranging == engine::RangingEngine::grid ? 0.1 : 1e-4;
    const std::vector<float> thin = read_of(0, ranging);
    const std::vector<float> narrow = read_of(1e-6, ranging);
    const std::vector<float> wide = read_of(0.2, ranging);
    ASSERT_EQ(thin.size(), 50u);
    for (std::size_t i = 0; i < thin.size(); ++i) {
      EXPECT_NEAR(narrow[i], thin[i], rounding) << i;
      const double off = std::acos(std::min(2.0 / thin[i], 1.0));  // of the beam from the wall's normal
      const double nearest = i < 20 ? thin[i] : 2 / std::cos(std::max(off - 0.1, 0.0));
      EXPECT_NEAR(wide[i], nearest, rounding) << i;
    }
    EXPECT_GT(*std::max_element(wide.begin() + 20, wide.begin() + 40), 2 / std::cos(0.2));
  }
}

/// Among boxes of all kinds: no farther than any of the points along their edges that lie in the beam, and as
/// near as the nearest of these, up to the points' distance.
TEST(RangerCone, IsTrueToPointsAlongAllEdges) {
  constexpr int k_worlds = test::k_slow_build ? 3 : 40;
  constexpr double k_width = 0.5;
  constexpr double k_step = 0.002;
  int met = 0;
  for (int w = 0; w < k_worlds; ++w) {
    Random random(11, 0, static_cast<std::uint32_t>(w), 0);
    const Pose pose{random.uniform(-1, 1), random.uniform(-1, 1), 0, random.uniform(-3, 3)};
    NoiseScene scene({{"beam_width", k_width}}, 1, false, pose);
    double nearest = 5;
    for (int b = 0; b < 12; ++b) {
      std::string name = "b";
      name += std::to_string(b);
      const Solid solid = box(random.uniform(0.1, 1.5), random.uniform(0.1, 0.5));
      const Pose place{random.uniform(-5, 5), random.uniform(-5, 5), 0, random.uniform(-3, 3)};
      scene.body(name, b % 2 == 0 ? scene.robot(name, {solid}) : scene.type(name, {solid}), place);
      for (const Ring& ring : placed(solid, place).contours)
        for (std::size_t i = 0; i < ring.size(); ++i) {
          const Vec2 a = ring[i] - pose.position();
          const Vec2 along = ring[(i + 1) % ring.size()] - ring[i];
          for (double t = 0; t <= 1; t += k_step) {
            const Vec2 point = a + t * along;
            const double off = std::remainder(std::atan2(point.y(), point.x()) - pose.heading, 2 * k_pi);
            if (std::abs(off) <= k_width / 2) nearest = std::min(nearest, point.norm());
          }
        }
    }
    const float reading = readings(scene)[0];
    EXPECT_LE(reading, nearest + 1e-6) << w;
    EXPECT_GE(reading, nearest - 1.5 * k_step * 4) << w;
    met += nearest < 5;
  }
  EXPECT_GT(met, k_worlds / 2);
}

}  // namespace
}  // namespace troupe::sensors::ranger_noise_test
