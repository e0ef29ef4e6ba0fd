#include "tests/support/scene.hpp"

#include "partition/ranging.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>

namespace troupe::sensors::ranger_test {
namespace {

using engine::World;
using test::SceneBuilder;
using test::Transducer;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::FloatNear;

#ifdef NDEBUG
constexpr std::uint32_t k_share = 1;
#else
constexpr std::uint32_t k_share = 40;  // of the random worlds in debug builds, which are that much slower
#endif

std::span<const float> readings(const World& world, BodyId body, std::size_t sensor = 0,
                                std::size_t field = 0) {
  const Row row = world.view().row(body);
  return world.tables()[world.view().type(row).devices[sensor].table].cell<float>(world.view().slot(row),
                                                                                  field);
}

// ---- random worlds

/// A world of everything that rays can meet, with the rangers of each type beside it.
struct RandomScene {
  SceneBuilder scene;
  std::vector<std::vector<std::vector<Transducer>>> rangers;  ///< by type, by sensor
};

Ring blob(Random& random, const Vec2& middle, double size) {
  Ring ring;
  const std::uint32_t n = 3 + random.below(9);
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * k_pi * (i + random.uniform(0, 0.9)) / n;
    ring.push_back(middle + size * random.uniform(0.3, 1) * Vec2(std::cos(angle), std::sin(angle)));
  }
  return ring;
}

std::string numbered(std::string name, std::uint32_t n) { return name.append(std::to_string(n)); }

float any_return(Random& random) {
  constexpr std::array<float, 5> k_returns{-1, 0, 0.5f, 1, 1};
  return k_returns[random.below(k_returns.size())];
}

std::vector<Transducer> any_ranger(Random& random) {
  std::vector<Transducer> out;
  const double range_max = random.uniform(0.5, 12);
  if (random.below(2) == 0) {  // a scanner
    out.push_back({.pose = {random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(0, 0.6),
                            random.uniform(-3, 3)},
                   .range_max = range_max,
                   .fov = random.uniform(0, 2 * k_pi),
                   .samples = static_cast<int>(1 + random.below(random.below(4) == 0 ? 360 : 24))});
    return out;
  }
  const std::uint32_t n = 1 + random.below(16);  // a ring
  const bool same_height = random.below(2) == 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * k_pi * i / n;
    out.push_back({.pose = {0.2 * std::cos(angle), 0.15 * std::sin(angle),
                            same_height ? 0.2 : 0.1 * random.below(6), angle},
                   .range_max = random.below(3) == 0 ? random.uniform(0.5, 12) : range_max,
                   .fov = 0.3,
                   .samples = static_cast<int>(1 + random.below(3))});
  }
  return out;
}

RandomScene random_scene(std::uint32_t seed, const Vec2& place) {
  Random random(seed, 1, 0, 0);
  RandomScene out;
  SceneBuilder& scene = out.scene;
  const double extent = random.uniform(1, 8);
  const auto anywhere = [&] {
    return Vec2(place.x() + random.uniform(-extent, extent), place.y() + random.uniform(-extent, extent));
  };

  for (std::uint32_t i = 0, n = random.below(4); i < n; ++i) {  // floor plans: regions with holes
    const double z = random.below(3) == 0 ? random.uniform(0, 0.5) : 0;
    Solid region{{}, {z, z + random.uniform(0.1, 1)}};
    for (std::uint32_t k = 0, m = 1 + random.below(6); k < m; ++k)
      region.contours.push_back(blob(random,
                                     Vec2(random.uniform(-extent, extent), random.uniform(-extent, extent)),
                                     random.uniform(0.1, extent)));
    const TypeId type =
        scene.type(numbered("plan", i), {region}, {.obstacle = false, .ranger = any_return(random)});
    scene.body(numbered("plan", i), type, {place.x(), place.y(), 0, random.uniform(-3, 3)});
  }
  out.rangers.resize(scene.spec.types.size());
  for (std::uint32_t t = 0, n = 1 + random.below(4); t < n; ++t) {
    std::vector<Solid> solids;
    for (std::uint32_t k = 0, m = 1 + random.below(3); k < m; ++k) {
      const double z = random.below(2) == 0 ? 0 : random.uniform(0, 0.5);
      solids.push_back({{blob(random, Vec2(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2)),
                              random.uniform(0.02, 0.4))},
                        {z, z + random.uniform(0, 0.5)}});
    }
    if (random.below(8) == 0)
      solids[0].contours[0] = blob(random, {0, 0}, random.uniform(0.5, 4));  // a truck
    const TypeId type = scene.robot(numbered("robot", t), solids);
    for (engine::PartSpec& part : scene[type].parts) part.returns.ranger = any_return(random);
    if (random.below(3) == 0)
      scene[type].parts.push_back({.name = "top",
                                   .kind = "model",
                                   .solids = {{{blob(random, {0, 0}, 0.2)}, {0.2, 0.4}}},
                                   .returns = {true, any_return(random)}});
    out.rangers.emplace_back();
    for (std::uint32_t s = 0, m = random.below(3); s < m; ++s) {
      const std::vector<Transducer> transducers = any_ranger(random);
      scene[type].devices.push_back(test::ranger(numbered("ranger", s), transducers, random.below(2) == 0));
      scene[type].devices.back().pose_body_device = {random.uniform(-0.1, 0.1), 0, random.uniform(0, 0.2),
                                                     random.uniform(-3, 3)};
      out.rangers.back().push_back(transducers);
    }
    for (std::uint32_t b = 0, m = 1 + random.below(12); b < m; ++b) {
      const Vec2 p = anywhere();
      scene.body(numbered("r", 100 * t + b), type,
                 {p.x(), p.y(), random.below(4) == 0 ? random.uniform(0, 0.4) : 0.0,
                  random.below(6) == 0 ? 0 : random.uniform(-3, 3)});
    }
  }
  return out;
}

/// What one beam reads by the formula alone: every edge of everything, without grid and culls.
struct Reading {
  float range;
  float intensity;
};

struct Formula {
  explicit Formula(const World& w) : world(w) {
    for (std::size_t s = 0; s < w.view().scene().solids().size(); ++s) {
      const partition::FixedSolid& fixed = w.view().scene().solids()[s];
      if (fixed.ranger_return < 0) continue;
      for (const Ring& ring : fixed.solid.contours)
        add(ring, fixed.solid.z, fixed.ranger_return, Row().value);
    }
    for (std::uint32_t r = 0; r < w.view().rows(); ++r)
      for (const engine::RayOutline& o : w.view().type(Row(r)).outlines)
        add(w.view().outline(Row(r)).subspan(o.first, o.count), o.z.shifted(w.view().poses()[r].z),
            o.ranger_return, r);
  }

  /// The readings of one sensor: what ranger.cpp documents, written down once more.
  std::vector<Reading> operator()(Row row, const Pose& pose_body_device,
                                  const std::vector<Transducer>& transducers) const {
    struct Beam {
      Vec2 origin, direction;
      double z;
      float range_max;
    };
    std::vector<Beam> beams;  // body frame
    for (const Transducer& t : transducers) {
      const Pose pose = compose(pose_body_device, t.pose);
      for (int i = 0; i < t.samples; ++i) {
        const SinCos way =
            sincos(pose.heading + (t.samples == 1 ? 0.0 : -t.fov / 2 + i * (t.fov / (t.samples - 1))));
        beams.push_back({pose.position(), {way.cos, way.sin}, pose.z, static_cast<float>(t.range_max)});
      }
    }
    const bool common =
        std::ranges::all_of(beams, [&](const Beam& b) { return b.origin == beams[0].origin; });
    const Vec2 reference_body = common ? beams[0].origin : pose_body_device.position();
    const Transform body(world.view().poses()[row.index()]);
    const Vec2 reference = body * reference_body;
    std::vector<partition::RayEdge> relative;
    for (const Edge& e : edges)
      relative.push_back(partition::relative_edge(e.a, e.b, reference, e.ranger_return));

    std::vector<Reading> out;
    for (const Beam& b : beams) {
      const Vec2 d = body.rotation * b.direction;
      const Vec2 o = body.rotation * Vec2(b.origin - reference_body);
      const double z = world.view().poses()[row.index()].z + b.z;
      float inverse = 0;
      float met = 0;
      for (std::size_t e = 0; e < edges.size(); ++e) {
        if (edges[e].row == row.value || !edges[e].z.contains(z)) continue;
        const float value = partition::inverse_range(
            relative[e], static_cast<float>(d.x()), static_cast<float>(d.y()),
            static_cast<float>(common ? 0 : o.x()), static_cast<float>(common ? 0 : o.y()));
        if (value > inverse || (value == inverse && value > 0 && edges[e].ranger_return > met))
          met = edges[e].ranger_return;
        inverse = std::max(inverse, value);
      }
      out.push_back({partition::range_of(inverse, b.range_max), inverse > 1.0f / b.range_max ? met : 0});
    }
    return out;
  }

 private:
  struct Edge {
    Vec2 a, b;
    ZInterval z;
    float ranger_return;
    std::uint32_t row;
  };
  void add(std::span<const Vec2> ring, const ZInterval& z, float ranger_return, std::uint32_t row) {
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++)
      if (ring[j] != ring[i]) edges.push_back({ring[j], ring[i], z, ranger_return, row});
  }

  const World& world;
  std::vector<Edge> edges;
};

/// visit(row, sensor index, its transducers) for each ranger of each robot.
template <class Visit>
void for_each_ranger(const World& world, const RandomScene& random, Visit&& visit) {
  for (std::uint32_t r = 0; r < world.view().rows(); ++r) {
    const auto& rangers = random.rangers[world.spec().bodies[world.view().body(Row(r)).index()].type.index()];
    for (std::size_t s = 0; s < rangers.size(); ++s) visit(Row(r), s, rangers[s]);
  }
}

TEST(Ranger, GridTilesThreadsAndCullsChangeNoBit) {
  constexpr std::array<engine::WorldOptions, 5> k_options{{{.threads = 1},
                                                           {.threads = 2, .tile_size_m = 0.7},
                                                           {.threads = 8, .tile_size_m = 5},
                                                           {.threads = 2, .tile_size_m = 60},
                                                           {.threads = 1, .tile_size_m = 0.2}}};
  std::uint64_t beams = 0;
  std::uint64_t hits = 0;
  for (std::uint32_t seed = 0; seed < 2000 / k_share; ++seed) {
    const Vec2 place = seed % 4 == 0 ? Vec2(-1000.3, 812.7) : Vec2(0.1, 0);
    const RandomScene random = random_scene(seed, place);
    // The formula's readings are made once, and two of the ways to cut the plane are compared with them.
    std::vector<std::vector<Reading>> expected;
    for (const std::size_t way : {seed % 5, (seed + 1 + seed / 5 % 4) % 5}) {
      World world = random.scene.world(k_options[way]);
      if (expected.empty()) {
        const Formula formula(world);
        for_each_ranger(
            world, random, [&](Row row, std::size_t s, const std::vector<Transducer>& transducers) {
              const auto type = world.spec().bodies[world.view().body(row).index()].type;
              expected.push_back(
                  formula(row, world.spec().types[type.index()].devices[s].pose_body_device, transducers));
            });
      }
      world.step();
      std::size_t next = 0;
      for_each_ranger(world, random, [&](Row row, std::size_t s, const std::vector<Transducer>&) {
        const std::span<const float> ranges = readings(world, world.view().body(row), s);
        const auto& sensor = world.view().type(row).devices[s];
        const std::vector<Reading>& want = expected[next++];
        ASSERT_EQ(ranges.size(), want.size());
        for (std::size_t i = 0; i < want.size(); ++i) {
          ASSERT_EQ(std::bit_cast<std::uint32_t>(ranges[i]), std::bit_cast<std::uint32_t>(want[i].range))
              << ranges[i] << " for " << want[i].range << ", seed " << seed << " row " << row.value
              << " beam " << i << " way " << way;
          if (sensor.prepared.percepts.size() > 1) {
            ASSERT_EQ(readings(world, world.view().body(row), s, 1)[i], want[i].intensity)
                << "seed " << seed << " beam " << i;
          }
          hits += want[i].intensity > 0;
        }
        beams += want.size();
      });
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(beams, 500'000u / k_share);
  EXPECT_GT(hits, beams / 10);
}

TEST(Ranger, InACrowdOfThousandsCullsChangeNoBit) {
  RandomScene random;
  SceneBuilder& scene = random.scene;
  Random numbers(5, 1, 0, 0);
  const std::vector<Transducer> ring = any_ranger(numbers);
  const std::vector<Transducer> scanner{{.pose = {0, 0, 0.1, 0}, .range_max = 6, .fov = 6, .samples = 300}};
  const TypeId crowd = scene.robot("crowd", {{{test::box_ring(0.1, 0.06)}, {0, 0.2}}});
  const TypeId watcher = scene.robot("watcher", {{{test::box_ring(0.1, 0.1)}, {0, 0.2}}});
  scene[watcher].devices = {test::ranger("ring", ring), test::ranger("scanner", scanner, true)};
  random.rangers = {{}, {}, {ring, scanner}};
  for (std::uint32_t i = 0; i < 3000;
       ++i)  // nearly all within reach: several blocks of them are worked through
    scene.body(numbered("b", i), i % (100 * k_share) == 0 ? watcher : crowd,
               {numbers.uniform(-3, 3), numbers.uniform(-3, 3), 0, numbers.uniform(-3, 3)});
  scene.wall(-2, 1, 2, 1.02);
  World world = scene.world();
  const Formula formula(world);
  world.step();
  for_each_ranger(world, random, [&](Row row, std::size_t s, const std::vector<Transducer>& transducers) {
    const std::vector<Reading> want = formula(row, {}, transducers);
    const std::span<const float> ranges = readings(world, world.view().body(row), s);
    for (std::size_t i = 0; i < want.size(); ++i) ASSERT_EQ(ranges[i], want[i].range) << "row " << row.value;
  });
}

// ---- against textbook geometry

/// Ray against segment in double, by solving for the two parameters; shares no code with the engine.
struct Segment {
  double ax, ay, bx, by, z_min, z_max;
  std::uint32_t body;
};

std::vector<Segment> all_segments(const engine::WorldSpec& spec) {
  std::vector<Segment> out;
  for (std::uint32_t b = 0; b < spec.bodies.size(); ++b) {
    const Pose& pose = spec.bodies[b].pose_world_body;
    const double c = std::cos(pose.heading), s = std::sin(pose.heading);
    for (const engine::PartSpec& part : spec.type(BodyId(b)).parts) {
      if (part.returns.ranger < 0) continue;
      for (const Solid& solid : part.solids) {
        for (const Ring& ring : solid.contours) {
          for (std::size_t i = 0; i < ring.size(); ++i) {
            const Vec2 &p = ring[i], &q = ring[(i + 1) % ring.size()];
            out.push_back({pose.x + c * p.x() - s * p.y(), pose.y + s * p.x() + c * p.y(),
                           pose.x + c * q.x() - s * q.y(), pose.y + s * q.x() + c * q.y(),
                           pose.z + solid.z.min, pose.z + solid.z.max, b});
          }
        }
      }
    }
  }
  return out;
}

struct Comparison {
  std::uint64_t beams = 0;
  std::uint64_t at_ends = 0;  ///< differ, and pass within 1e-5 m of an edge's end
  std::uint64_t wrong = 0;
  std::string first;
};

void compare(const std::vector<Segment>& segments, std::uint32_t own, double ox, double oy, double z,
             double angle, double range_max, float reading, Comparison& out) {
  constexpr double k_tolerance = 1e-5;
  const double dx = std::cos(angle), dy = std::sin(angle);
  double low = static_cast<float>(range_max), high = low;
  bool near_end = false;
  for (const Segment& s : segments) {
    if (s.body == own || z < s.z_min || z > s.z_max) continue;
    const double ex = s.bx - s.ax, ey = s.by - s.ay;
    const double determinant = dx * ey - dy * ex;
    const double t = ((s.ax - ox) * ey - (s.ay - oy) * ex) / determinant;
    const double u = ((s.ax - ox) * dy - (s.ay - oy) * dx) / determinant;
    const double sine = std::abs(determinant) / std::sqrt(ex * ex + ey * ey);
    if (u >= 0 && u <= 1 && t >= 0) {
      low = std::min(low, t - k_tolerance / sine);
      high = std::min(high, t + k_tolerance / sine);
    }
    const double aside = std::abs((s.ax - ox) * dy - (s.ay - oy) * dx);
    const double along = (s.ax - ox) * dx + (s.ay - oy) * dy;
    near_end = near_end || (aside < k_tolerance && along > -k_tolerance && along < range_max + k_tolerance);
  }
  ++out.beams;
  if (reading >= low && reading <= high) return;
  if (near_end) {
    ++out.at_ends;
    return;
  }
  if (out.wrong++ == 0)
    out.first =
        std::to_string(reading) + " m, should be " + std::to_string(low) + " to " + std::to_string(high);
}

void expect_true_ranges(const Vec2& place, std::uint32_t first_seed) {
  Comparison comparison;
  for (std::uint32_t seed = first_seed; seed < first_seed + 1500 / k_share; ++seed) {
    const RandomScene random = random_scene(seed, place);
    World world = random.scene.world();
    world.step();
    const std::vector<Segment> segments = all_segments(world.spec());
    for_each_ranger(world, random, [&](Row row, std::size_t s, const std::vector<Transducer>& transducers) {
      const BodyId body = world.view().body(row);
      const engine::BodySpec& spec = world.spec().bodies[body.index()];
      const Pose& mount = world.spec().types[spec.type.index()].devices[s].pose_body_device;
      std::size_t beam = 0;
      for (const Transducer& t : transducers) {
        const double heading = spec.pose_world_body.heading + mount.heading;
        const double mx = mount.x + std::cos(mount.heading) * t.pose.x - std::sin(mount.heading) * t.pose.y;
        const double my = mount.y + std::sin(mount.heading) * t.pose.x + std::cos(mount.heading) * t.pose.y;
        const double c = std::cos(spec.pose_world_body.heading), sn = std::sin(spec.pose_world_body.heading);
        for (int i = 0; i < t.samples; ++i) {
          const double angle = heading + t.pose.heading +
                               (t.samples > 1 ? t.fov * (static_cast<double>(i) / (t.samples - 1) - 0.5) : 0);
          compare(segments, body.value, spec.pose_world_body.x + c * mx - sn * my,
                  spec.pose_world_body.y + sn * mx + c * my, spec.pose_world_body.z + mount.z + t.pose.z,
                  angle, t.range_max, readings(world, body, s)[beam++], comparison);
        }
      }
    });
  }
  EXPECT_EQ(comparison.wrong, 0u) << "of " << comparison.beams << "; first: " << comparison.first;
  EXPECT_LT(comparison.at_ends * 10000, comparison.beams);
  EXPECT_GT(comparison.beams, 300'000u / k_share);
  std::printf("%llu beams; %llu differ that pass within 1e-5 m of an edge's end\n",
              static_cast<unsigned long long>(comparison.beams),
              static_cast<unsigned long long>(comparison.at_ends));
}

TEST(Ranger, RangesAreTrueToTextbookGeometry) { expect_true_ranges({0, 0}, 100'000); }
TEST(Ranger, RangesAreTrueFarFromTheOriginToo) { expect_true_ranges({1000.7, -730.1}, 200'000); }

// ---- what a ranger means

/// A robot at the origin with one ranger, and what the test adds.
struct RobotScene : SceneBuilder {
  TypeId robot_type = robot("robot", {});
  BodyId robot_body;

  explicit RobotScene(const std::vector<Transducer>& transducers, bool intensity = true) {
    (*this)[robot_type].devices.push_back(test::ranger("ranger", transducers, intensity));
    robot_body = body("r", robot_type);
  }
  std::vector<float> ranges() const {
    World w = world();
    w.step();
    const auto r = readings(w, robot_body);
    return {r.begin(), r.end()};
  }
  std::vector<float> intensities() const {
    World w = world();
    w.step();
    const auto r = readings(w, robot_body, 0, 1);
    return {r.begin(), r.end()};
  }
};

constexpr double k_quarter = k_pi / 2;

TEST(Conformance08, RangesBetweenFourWalls) {
  const auto walled = [](RobotScene s) {
    s.wall(2, -3, 2.2, 3);
    s.wall(-2.2, -3, -2, 3);
    s.wall(-3, -2.2, 3, -2);
    s.wall(-3, 2, 3, 2.2);
    return s.ranges();
  };
  const auto ahead = [](double heading) { return Transducer{.pose = {0, 0, 0.5, heading}, .range_max = 5}; };
  EXPECT_THAT(walled(RobotScene({ahead(0), ahead(2 * k_quarter), ahead(-k_quarter), ahead(k_quarter)})),
              Each(FloatNear(2, 1e-6f)));
  const std::vector<float> fan =
      walled(RobotScene({{.pose = {0, 0, 0.5, 0}, .range_max = 5, .fov = k_quarter, .samples = 5}}));
  const float diagonal = std::sqrt(8.0f), slanted = static_cast<float>(2 / std::cos(k_pi / 8));
  EXPECT_THAT(fan, ElementsAre(FloatNear(diagonal, 1e-5f), FloatNear(slanted, 1e-5f), FloatNear(2, 1e-6f),
                               FloatNear(slanted, 1e-5f), FloatNear(diagonal, 1e-5f)));
  // As Stage prints them, to a cell and a half.
  EXPECT_THAT(fan, ElementsAre(FloatNear(2.8284f, 0.03f), FloatNear(2.1648f, 0.03f), FloatNear(2, 0.03f),
                               FloatNear(2.1648f, 0.03f), FloatNear(2.8001f, 0.03f)));
}

TEST(Conformance09, NoHitIsExactlyRangeMaxWithoutIntensity) {
  const RobotScene s({{.pose = {0, 0, 0.5, 0}, .range_max = 3.7}});
  EXPECT_THAT(s.ranges(), ElementsAre(3.7f));
  EXPECT_THAT(s.intensities(), ElementsAre(0.0f));
}

TEST(Conformance09, AnObjectOfReturnZeroIsHitWithIntensityZero) {
  RobotScene s({{.pose = {0, 0, 0.5, 0}}});
  s.wall(2, -1, 2.1, 1, {.obstacle = true, .ranger = 0});
  EXPECT_THAT(s.ranges(), ElementsAre(2.0f));
  EXPECT_THAT(s.intensities(), ElementsAre(0.0f));
}

TEST(Conformance09, ANegativeReturnIsTransparent) {
  RobotScene s({{.pose = {0, 0, 0.5, 0}}});
  s.wall(2, -1, 2.1, 1, {.obstacle = true, .ranger = -1});
  s.wall(3, -1, 3.1, 1, {.obstacle = true, .ranger = 0.25f});
  const TypeId ghost = s.robot("ghost", {{{test::box_ring(0.4, 0.4)}, {0, 1}}});
  s[ghost].parts[0].returns.ranger = -1;
  s.body("g", ghost, {1, 0, 0, 0});
  EXPECT_THAT(s.ranges(), ElementsAre(3.0f));
  EXPECT_THAT(s.intensities(), ElementsAre(0.25f));
}

TEST(Conformance09, WhatIsLowerThanTheRayIsMissed) {
  RobotScene s({{.pose = {0, 0, 0.5, 0}}});
  s.body("low", s.type("low", {{{test::box_ring(0.4, 0.4)}, {0, 0.4}}}), {1, 0, 0, 0});
  s.body("low robot", s.robot("low robot", {{{test::box_ring(0.4, 0.4)}, {0, 0.4}}}), {2, 0, 0, 0});
  s.wall(3, -1, 3.1, 1);
  EXPECT_THAT(s.ranges(), ElementsAre(3.0f));
}

TEST(Ranger, HeightIntervalsAreClosed) {
  const auto meets = [](double z_min, double z_max, double ray, bool fixed) {
    RobotScene s({{.pose = {0, 0, ray, 0}}});
    const std::vector<Solid> solids{{{test::box_ring(1, 1)}, {z_min, z_max}}};
    s.body("box", fixed ? s.type("box", solids) : s.robot("box", solids), {2, 0, 0, 0});
    return s.ranges()[0] == 1.5f;
  };
  for (const bool fixed : {true, false}) {
    EXPECT_TRUE(meets(0.25, 0.5, 0.25, fixed));
    EXPECT_TRUE(meets(0.25, 0.5, 0.5, fixed));
    EXPECT_FALSE(meets(0.25, 0.5, 0.2499999, fixed));
    EXPECT_FALSE(meets(0.25, 0.5, 0.5000001, fixed));
    EXPECT_TRUE(meets(0.5, 0.5, 0.5, fixed)) << "a block without height is met at its height";
  }
}

TEST(Ranger, HeightsOfRobotAndBodyCount) {
  RobotScene s({{.pose = {0, 0, 0.1, 0}}});
  const TypeId box = s.robot("box", {{{test::box_ring(1, 1)}, {0, 0.5}}});
  s.body("box", box, {2, 0, 0.6, 0});
  EXPECT_THAT(s.ranges(), ElementsAre(5.0f));
  s.spec.bodies[s.robot_body.index()].pose_world_body.z = 0.6;
  EXPECT_THAT(s.ranges(), ElementsAre(1.5f));
}

TEST(Ranger, EachTransducerLooksAtItsHeightAndEachBodyIsAtIts) {
  // A wide foot up to 0.25 m, and a narrow head above it. Of the same type: one on the floor ahead, one that
  // stands 0.25 m higher to the left.
  RobotScene s({{.pose = {0, 0, 0.125, 0}},
                {.pose = {0, 0, 0.125, k_quarter}},
                {.pose = {0, 0, 0.375, 0}},
                {.pose = {0, 0, 0.375, k_quarter}}});
  const TypeId post =
      s.robot("post", {{{test::box_ring(1, 1)}, {0, 0.25}}, {{test::box_ring(0.5, 0.5)}, {0.25, 0.5}}});
  s.body("ahead", post, {2, 0, 0, 0});
  s.body("left", post, {0, 3, 0.25, 0});
  EXPECT_THAT(s.ranges(),
              ElementsAre(FloatNear(1.5f, 1e-6f), 5.0f, FloatNear(1.75f, 1e-6f), FloatNear(2.5f, 1e-6f)));
}

TEST(Ranger, TheRobotsOwnBodyIsNotSeen) {
  RobotScene s({{.pose = {0, 0, 0.5, 0}}});
  auto& parts = s[s.robot_type].parts;
  parts[0].solids = {{{test::box_ring(1, 1)}, {0, 1}}};
  parts.push_back(
      {.name = "mast", .kind = "model", .solids = {{{test::rectangle(0.6, -1, 0.7, 1)}, {0, 1}}}});
  EXPECT_THAT(s.ranges(), ElementsAre(5.0f));
  s.body("twin", s.robot_type, {3, 0, 0, 2 * k_quarter});
  EXPECT_THAT(s.ranges(), ElementsAre(FloatNear(2.3f, 1e-6f)))
      << "but that of another of its type is: the twin's mast";
}

TEST(Ranger, EdgesAreTwoSidedAndABeamThatStartsInsideMeetsTheInnerFace) {
  RobotScene s({{.pose = {0, 0, 0.5, 0}, .fov = k_quarter, .samples = 2}});
  s.body("fixed", s.type("fixed", {{{test::box_ring(4, 4)}, {0, 1}}}));
  EXPECT_THAT(s.ranges(), Each(FloatNear(std::sqrt(8.0f), 1e-6f)));
  s.body("robot", s.robot("big", {{{test::box_ring(2, 2)}, {0, 1}}}));
  EXPECT_THAT(s.ranges(), Each(FloatNear(std::sqrt(2.0f), 1e-6f)));
}

TEST(Ranger, AHoleOfAFloorPlanIsSeenFromWithin) {
  RobotScene s({{.pose = {0, 0, 0.5, 0}}});
  s.body("plan", s.type("plan", {{{test::box_ring(10, 10), test::box_ring(3, 3)}, {0, 1}}}));
  EXPECT_THAT(s.ranges(), ElementsAre(1.5f));
}

TEST(Ranger, SamplesRunFromRightToLeftAndTransducersInTheirOrder) {
  RobotScene s(
      {{.pose = {0, 0, 0.5, 0}, .fov = 2 * k_quarter, .samples = 3}, {.pose = {0, 0, 0.5, 2 * k_quarter}}});
  s.wall(-3, -1.1, 3, -1);      // right
  s.wall(2, -0.5, 2.1, 0.5);    // ahead
  s.wall(-3, 3, 3, 3.1);        // left
  s.wall(-4.1, -0.5, -4, 0.5);  // behind
  EXPECT_THAT(s.ranges(), ElementsAre(FloatNear(1, 1e-6f), FloatNear(2, 1e-6f), FloatNear(3, 1e-6f),
                                      FloatNear(4, 1e-6f)));
}

TEST(Ranger, OneSampleLooksStraightAheadWhateverItsFov) {
  RobotScene s({{.pose = {0, 0, 0.5, 0}, .fov = 3, .samples = 1}});
  s.wall(2, -0.01, 2.1, 0.01);
  EXPECT_THAT(s.ranges(), ElementsAre(2.0f));
}

TEST(Ranger, SensorAndTransducerPosesAreComposed) {
  RobotScene s({{.pose = {1, 0, 0.2, k_quarter}}});
  s[s.robot_type].devices[0].pose_body_device = {0.5, 0, 0.3,
                                                 k_quarter};  // transducer at (0.5, 1, 0.5), looking back
  s.spec.bodies[s.robot_body.index()].pose_world_body = {10, 20, 0,
                                                         -k_quarter};  // at (11, 19.5), looking to +y
  s.wall(10, 21.5, 12, 22);
  EXPECT_THAT(s.ranges(), ElementsAre(FloatNear(2, 1e-5f)));
}

TEST(Ranger, SeveralSensorsReportApartAndRangesDiffer) {
  RobotScene s({{.pose = {0, 0, 0.5, 0}}});
  s[s.robot_type].devices.push_back(test::ranger(
      "second",
      {{.pose = {0, 0, 0.5, 2 * k_quarter}, .range_max = 2}, {.pose = {0.5, 0, 0.5, 0}, .range_max = 8}}));
  s.wall(6, -1, 6.1, 1);
  World world = s.world();
  world.step();
  EXPECT_THAT(readings(world, s.robot_body, 0), ElementsAre(5.0f));
  EXPECT_THAT(readings(world, s.robot_body, 1), ElementsAre(2.0f, FloatNear(5.5f, 1e-6f)));
  EXPECT_EQ(world.counters().beams, 3u);
}

TEST(Ranger, TheLargerIntensityIsReportedOfTwoAtOneDistance) {
  for (const float first : {0.25f, 0.75f}) {
    RobotScene s({{.pose = {0, 0, 0.5, 0}}});
    s.wall(2, -1, 2.1, 1, {.obstacle = true, .ranger = first});
    s.wall(2, -1, 2.1, 1, {.obstacle = true, .ranger = 1 - first});
    EXPECT_THAT(s.intensities(), ElementsAre(0.75f));
  }
}

TEST(Ranger, ReadingsHaveNoNoise) {
  RobotScene s({{.pose = {0, 0, 0.5, 0.3}, .range_max = 8, .fov = 3, .samples = 50}});
  s.wall(-3, -3, 3, 3);
  World world = s.world();
  world.step();
  const auto first = readings(world, s.robot_body);
  const std::vector<float> before(first.begin(), first.end());
  for (int i = 0; i < 5; ++i) world.step();
  const auto last = readings(world, s.robot_body);
  EXPECT_EQ(before, std::vector<float>(last.begin(), last.end()));
}

TEST(Ranger, ReadingsAreThoseOfTheStateBeforeTheTick) {
  RobotScene s({{.pose = {0, 0, 0.5, 0}}});
  s.wall(4, -1, 4.1, 1);
  World world = s.world();
  world.set_command(world.view().row(s.robot_body), {0.5, 0, 0});
  world.step();
  EXPECT_THAT(readings(world, s.robot_body), ElementsAre(4.0f));
  EXPECT_DOUBLE_EQ(world.view().pose(s.robot_body).x, 0.05);
  world.step();
  EXPECT_THAT(readings(world, s.robot_body), ElementsAre(FloatNear(3.95f, 1e-6f)));
}

TEST(Ranger, ASlowSensorKeepsItsOldReading) {
  RobotScene s({{.pose = {0, 0, 0.5, 0}}});
  s[s.robot_type].devices[0].period_s = 0.25;  // runs at 0.3, 0.6, ... s, as in Stage
  s.wall(4, -1, 4.1, 1);
  World world = s.world();
  world.set_command(world.view().row(s.robot_body), {1, 0, 0});
  std::vector<float> seen;
  for (int tick = 1; tick <= 7; ++tick) {
    world.step();
    seen.push_back(readings(world, s.robot_body)[0]);
  }
  const auto third = FloatNear(3.8f, 1e-5f), sixth = FloatNear(3.5f, 1e-5f);
  EXPECT_THAT(seen, ElementsAre(0.0f, 0.0f, third, third, third, sixth, sixth));
  EXPECT_EQ(world.counters().beams, 2u);
}

TEST(Ranger, AnInactiveSensorIsNotRunUntilItIsActivated) {
  RobotScene s({{.pose = {0, 0, 0.5, 0}}});
  s[s.robot_type].devices[0].active = false;
  World world = s.world();
  world.step();
  EXPECT_EQ(world.counters().beams, 0u);
  EXPECT_THAT(readings(world, s.robot_body), ElementsAre(0.0f));
  world.subscribe(s.robot_body);
  world.step();
  EXPECT_EQ(world.counters().beams, 1u);
  EXPECT_THAT(readings(world, s.robot_body), ElementsAre(5.0f));
}

TEST(Ranger, AScannerOfManyHundredBeamsIsCastWhole) {
  RobotScene s({{.pose = {0, 0, 0.5, 0}, .range_max = 8, .fov = 2 * k_pi, .samples = 1001}});
  s.body("room", s.type("room", {{{test::box_ring(6, 6)}, {0, 1}}}));
  const std::vector<float> ranges = s.ranges();
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double angle = -k_pi + 2 * k_pi * static_cast<double>(i) / 1000;
    EXPECT_NEAR(ranges[i], 3 / std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle))), 1e-5);
  }
}

}  // namespace
}  // namespace troupe::sensors::ranger_test
