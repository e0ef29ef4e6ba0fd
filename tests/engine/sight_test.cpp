#include "engine/sensing/sight.hpp"

#include "base/random.hpp"
#include "engine/sensing/visibility_query.hpp"
#include "tests/support/scene.hpp"
#include "tests/support/slow_build.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace troupe::engine::sight_test {
namespace {

using test::box;
using test::SceneBuilder;

/// What a ray may meet, as the test knows it: one edge of a part.
struct Edge {
  Vec2 a, b;
  ZInterval z;
  BodyId body;
  std::uint32_t part;
};

std::vector<Edge> edges_of(const WorldSpec& spec) {
  std::vector<Edge> edges;
  for (std::size_t b = 0; b < spec.bodies.size(); ++b) {
    const TypeSpec& type = spec.type(BodyId(b));
    for (std::uint32_t p = 0; p < type.parts.size(); ++p)
      for (const Solid& solid : type.parts[p].solids) {
        const Solid there = placed(solid, spec.bodies[b].pose_world_body);
        for (const Ring& ring : there.contours)
          for (std::size_t i = 0; i < ring.size(); ++i)
            edges.push_back({ring[i], ring[(i + 1) % ring.size()], there.z, BodyId(b), p});
      }
  }
  return edges;
}

/// The textbook's way, over every edge there is.
RayHit oracle(const WorldSpec& spec, const std::vector<Edge>& edges, const SightRay& ray, BodyId own,
              BodyId target) {
  RayHit best{.range_m = ray.length};
  for (const Edge& edge : edges) {
    if (edge.body == own || edge.body == target || (ray.z && !edge.z.contains(*ray.z))) continue;
    const PartSpec& part = spec.type(edge.body).parts[edge.part];
    if (ray.stops != nullptr && !ray.stops(part.returns)) continue;
    const Vec2 along = edge.b - edge.a;
    const double parallel = cross(ray.direction, along);
    if (parallel == 0) continue;
    const double range = cross(edge.a - ray.origin, along) / parallel;
    const double share = cross(edge.a - ray.origin, ray.direction) / parallel;
    if (range >= 0 && share >= 0 && share <= 1 && range < best.range_m) best = {range, edge.body, edge.part};
  }
  return best;
}

SceneBuilder random_scene(Random& random) {
  SceneBuilder scene;
  std::vector<TypeId> types;
  for (int t = 0; t < 6; ++t) {
    std::string name = "t";
    name += std::to_string(t);
    const double width = random.uniform(0.1, t == 5 ? 4 : 0.6);
    const std::vector<Solid> solids{box(width, random.uniform(0.1, 0.6), random.uniform(0.2, 1))};
    const TypeId type = t % 2 == 0 ? scene.robot(name, solids) : scene.type(name, solids);
    scene[type].parts[0].returns.ranger = t % 3 == 0 ? -1.0f : 1.0f;
    scene[type].parts[0].returns.gripper = t < 3;
    if (t == 2) {  // a mast that rangers see on a base that they do not
      PartSpec mast{.name = "mast", .solids = {box(0.05, 0.05, 2)}};
      scene[type].parts[0].returns.ranger = -1;
      scene[type].parts.push_back(mast);
    }
    types.push_back(type);
  }
  for (int b = 0; b < 60; ++b) {
    std::string name = "b";
    name += std::to_string(b);
    scene.body(name, types[random.below(static_cast<std::uint32_t>(types.size()))],
               {random.uniform(-6, 6), random.uniform(-6, 6), random.below(4) == 0 ? 0.3 : 0,
                random.uniform(-k_pi, k_pi)});
  }
  scene.wall(-8, 7, 8, 7.2);
  scene.wall(-8, -7.2, 8, -7, {.ranger = -1});
  return scene;
}

TEST(Sight, MeetsFirstWhatBruteForceMeetsFirst) {
  constexpr int k_worlds = test::k_slow_build ? 2 : 12;
  constexpr int k_rays = test::k_slow_build ? 60 : 800;
  int met = 0;
  for (int w = 0; w < k_worlds; ++w) {
    Random random(7, 1, static_cast<std::uint32_t>(w), 0);
    const SceneBuilder scene = random_scene(random);
    const std::vector<Edge> edges = edges_of(scene.spec);
    const World world = scene.world({.threads = 1, .tile_size_m = w % 3 == 0 ? 0 : random.uniform(0.5, 20)});
    for (int r = 0; r < k_rays; ++r) {
      const double heading = random.uniform(-k_pi, k_pi);
      SightRay ray{.origin = {random.uniform(-7, 7), random.uniform(-7, 7)},
                   .direction = {troupe::cos(heading), troupe::sin(heading)},
                   .length = random.uniform(0.1, 12)};
      BodyId own;
      if (r % 3 != 0) ray.z = random.uniform(0, 1);
      if (r % 4 == 0) ray.stops = [](const Returns& returns) { return returns.gripper; };
      if (r % 2 == 0) {
        ray.own = Row(random.below(static_cast<std::uint32_t>(world.view().rows())));
        own = world.view().body(ray.own);
      }
      RayHit got = first_met(world.view(), ray);
      RayHit want = oracle(scene.spec, edges, ray, own, {});
      if (r % 5 < 2 && want.met() && world.view().row(want.body).valid()) {  // through that body
        ray.target = world.view().row(want.body);
        got = first_met(world.view(), ray);
        want = oracle(scene.spec, edges, ray, own, want.body);
      }
      ASSERT_NEAR(got.range_m, want.range_m, 1e-9) << "world " << w << ", ray " << r;
      ASSERT_EQ(got.body, want.body) << "world " << w << ", ray " << r;
      if (want.met()) {
        ASSERT_EQ(got.part, want.part);
      }
      met += want.met();
    }
  }
  EXPECT_GT(met, k_worlds * k_rays / 4);
}

/// From one point, with more rays than a fan has beams, and again from the next: what first_met() says, bit
/// for bit. Also in a crowd of which the nearest hide the rest, and far from the origin.
TEST(Sight, ALookoutMeetsTheSameAsOneRayAfterAnother) {
  constexpr int k_worlds = test::k_slow_build ? 2 : 12;
  constexpr int k_points = test::k_slow_build ? 6 : 40;
  int met = 0;
  for (int w = 0; w < k_worlds; ++w) {
    Random random(8, 1, static_cast<std::uint32_t>(w), 0);
    SceneBuilder scene = random_scene(random);
    const Vec2 middle = w % 4 == 3 ? Vec2(40000, -90000) : Vec2(0, 0);
    const TypeId post = scene.robot("post", {box(0.1, 0.1)});
    for (int b = 0; b < (w % 2 == 0 ? 0 : 200); ++b) {
      std::string name = "p";
      name += std::to_string(b);
      scene.body(name, post, {random.uniform(-6, 6), random.uniform(-6, 6), 0, 1});
    }
    for (std::size_t b = 1; b < scene.spec.bodies.size(); ++b) {
      scene.spec.bodies[b].pose_world_body.x += middle.x();
      scene.spec.bodies[b].pose_world_body.y += middle.y();
    }
    const World world = scene.world({.threads = 1, .tile_size_m = w % 3 == 0 ? 0 : random.uniform(0.5, 20)});
    VisibilityQuery query;
    for (int p = 0; p < k_points; ++p) {
      SightRay ray{.origin = middle + Vec2(random.uniform(-7, 7), random.uniform(-7, 7))};
      if (p % 3 != 0) ray.z = random.uniform(0, 1);
      if (p % 2 == 0) ray.own = Row(random.below(static_cast<std::uint32_t>(world.view().rows())));
      const double reach = random.uniform(0.5, 12);
      std::vector<SightLine> rays(1 + random.below(70));
      for (SightLine& line : rays) {
        const double heading = random.uniform(-k_pi, k_pi);
        line = {{troupe::cos(heading), troupe::sin(heading)}, reach * random.uniform(0, 1)};
        if (random.below(2) == 0)
          line.target = Row(random.below(static_cast<std::uint32_t>(world.view().rows())));
      }
      std::vector<RayHit> found(rays.size());
      query.stand(world.view(), ray.origin, reach, ray.own, ray.z);
      query.first_met(rays, found);
      std::vector<RayHit> found_at_once(rays.size());
      query.first_met(world.view(), ray.origin, ray.own, ray.z, rays, found_at_once);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        ray.direction = rays[i].direction;
        ray.length = rays[i].length;
        ray.target = rays[i].target;
        const RayHit want = first_met(world.view(), ray);
        ASSERT_EQ(found[i].range_m, want.range_m) << "world " << w << ", point " << p << ", ray " << i;
        ASSERT_EQ(found[i].body, want.body) << "world " << w << ", point " << p << ", ray " << i;
        ASSERT_EQ(found[i].part, want.part);
        ASSERT_EQ(found_at_once[i].range_m, want.range_m);
        ASSERT_EQ(found_at_once[i].body, want.body);
        ASSERT_EQ(found_at_once[i].part, want.part);
        met += want.met();
      }
    }
  }
  EXPECT_GT(met, k_worlds * k_points);
}

TEST(Sight, ALookoutKnowsWhoIsInReach) {
  SceneBuilder scene;
  const TypeId robot = scene.robot("robot", {box(0.2, 0.2)});
  const TypeId barge = scene.robot("barge", {box(6, 6)});  // lies in many cells
  const auto add = [&](const char* name, TypeId type, double x) {
    return scene.body(name, type, {x, 0, 0, 0});
  };
  const std::vector<BodyId> near{add("own", robot, 0), add("a", robot, 1), add("b", robot, -2.05),
                                 add("c", barge, 5)};
  add("far", robot, 2.3);
  const World world = scene.world();
  VisibilityQuery query;
  query.stand(world.view(), {0, 0}, 2, world.view().row(near[0]), {});
  std::vector<BodyId> found;
  for (const std::uint32_t row : query.bodies()) found.push_back(world.view().body(Row(row)));
  std::ranges::sort(found);
  EXPECT_EQ(found, (std::vector<BodyId>{near[1], near[2], near[3]}));
}

TEST(Sight, OfTwoSurfacesAtOneRangeTheLowerBodyIsMet) {
  SceneBuilder scene;
  const TypeId crate = scene.type("crate", {box(1, 1)});
  const TypeId robot = scene.robot("robot", {box(1, 1)});
  scene.body("robot", robot, {3, 0, 0, 0});
  const BodyId crate_body = scene.body("crate", crate, {3, 0, 0, 0});
  const World world = scene.world();
  EXPECT_EQ(first_met(world.view(), {.length = 9}).body, BodyId(1));
  EXPECT_EQ(first_met(world.view(), {.length = 9, .own = world.view().row(BodyId(1))}).body, crate_body);
  EXPECT_EQ(first_met(world.view(), {.length = 9}).range_m, 2.5);
  EXPECT_FALSE(first_met(world.view(), {.length = 2.5}).met());  // as far as the ray is long
}

TEST(Sight, NoRaySlipsBetweenTwoEdges) {
  SceneBuilder scene;
  const BodyId crate = scene.body("crate", scene.type("crate", {box(2, 2)}), {5, 0.3, 0, 0.1});
  const World world = scene.world();
  const Solid there = placed(box(2, 2), {5, 0.3, 0, 0.1});
  for (const Vec2& corner : there.contours[0])
    for (int i = 0; i < 100; ++i) {
      const Vec2 origin(0.01 * i, -0.013 * i);
      // From within the crate's width each corner lies before its far side.
      const Vec2 way = Vec2(5, 0.3) + 0.999999999999 * (corner - Vec2(5, 0.3)) - origin;
      const RayHit first =
          first_met(world.view(), {.origin = origin, .direction = way / way.norm(), .length = 20});
      EXPECT_EQ(first.body, crate) << i;
    }
}

TEST(Sight, AColourIsThePartsOrElseTheBodys) {
  SceneBuilder scene;
  const TypeId type = scene.type("post", {box(0.2, 0.2)});
  scene[type].parts.push_back({.name = "sign", .solids = {box(0.4, 0.4, 2)}, .color = Color{0, 0, 1, 1}});
  const BodyId post = scene.body("post", type, {2, 0, 0, 0});
  scene.spec.bodies[post.index()].color = {0, 1, 0, 1};
  const World world = scene.world();
  const RayHit sign = first_met(world.view(), {.length = 9});
  EXPECT_EQ(sign.part, 1u);
  EXPECT_EQ(color_of(world.view(), sign), (Color{0, 0, 1, 1}));
  EXPECT_EQ(color_of(world.view(), {.body = post, .part = 0}), (Color{0, 1, 0, 1}));
}

}  // namespace
}  // namespace troupe::engine::sight_test
