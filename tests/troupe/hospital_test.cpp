// The hospital after its swarm has dispersed: no robot overlaps a wall or another robot, and the density of
// walls is as intended. Uses the predicates of the static scene, but for each pair and each edge, without
// a grid.

#include "engine/observing/displacement.hpp"
#include "engine/world/world.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/registry.hpp"
#include "worldio/load.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <vector>

namespace troupe::hospital_test {
namespace {

double distance(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 ab = b - a;
  const double along = std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
  return (p - a - along * ab).norm();
}

/// Bodies that overlap the static scene, and pairs that overlap each other.
struct Overlaps {
  std::size_t with_walls = 0;
  std::size_t with_each_other = 0;
};

Overlaps overlaps(const engine::World& world) {
  Overlaps found;
  const auto shape = [&](std::size_t r) -> const partition::ObstacleShape& {
    return world.view().type(Row(r)).obstacle;
  };
  for (std::size_t a = 0; a < world.view().rows(); ++a) {
    const Pose& pose = world.view().poses()[a];
    found.with_walls += world.view().scene().blocked(shape(a), pose);
    for (std::size_t b = a + 1; b < world.view().rows(); ++b) {
      const Pose& other = world.view().poses()[b];
      const double apart = (pose.position() - other.position()).norm();
      if (apart <= shape(a).radius + shape(b).radius)
        found.with_each_other += partition::overlap(shape(a), pose, shape(b), other);
    }
  }
  return found;
}

/// Over all robots, the median number of static edges that come within `reach` of their centres.
std::size_t median_edges_near_robots(const engine::World& world, double reach) {
  std::vector<std::pair<Vec2, Vec2>> edges;
  for (const partition::FixedSolid& fixed : world.view().scene().solids())
    for (const Ring& ring : fixed.solid.contours)
      for (std::size_t i = 0; i < ring.size(); ++i) edges.emplace_back(ring[i], ring[(i + 1) % ring.size()]);
  EXPECT_EQ(edges.size(), world.view().scene().edge_count());
  std::vector<std::size_t> counts;
  for (const Pose& pose : world.view().poses()) {
    const Vec2 p = pose.position();
    counts.push_back(static_cast<std::size_t>(std::ranges::count_if(edges, [&](const auto& edge) {
      const auto& [a, b] = edge;
      if (std::min(a.x(), b.x()) > p.x() + reach || std::max(a.x(), b.x()) < p.x() - reach) return false;
      return distance(p, a, b) <= reach;
    })));
  }
  std::ranges::nth_element(counts, counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2));
  return counts[counts.size() / 2];
}

TEST(Hospital, NoRobotIsInAWallAndTheSwarmHasSpread) {
  const engine::Registry registry = make_registry();
  Diagnostics diagnostics;
  worldio::LoadOptions options;
  if (test::k_slow_build) options.robots = {{"", 150}};
  engine::WorldSpec spec =
      worldio::load_world(test::source_dir() / "worlds" / "hospital.json", registry, options, diagnostics);
  diagnostics.throw_if_errors();
  engine::World world(std::move(spec), registry, {}, diagnostics);
  EXPECT_TRUE(diagnostics.findings().empty());
  ASSERT_EQ(world.robots(), test::k_slow_build ? 150u : 2000u);
  ASSERT_TRUE(world.view().scene().has_obstacles());

  const Overlaps before = overlaps(world);
  EXPECT_EQ(before.with_walls, 0u);
  EXPECT_EQ(before.with_each_other, 0u);
  while (world.view().time_s() < (test::k_slow_build ? 5 : 60)) world.step();
  const Overlaps after = overlaps(world);
  EXPECT_EQ(after.with_walls, 0u);
  EXPECT_EQ(after.with_each_other, 0u);
  EXPECT_EQ(world.view().counts().out_of_bounds, 0u);
  EXPECT_LT(static_cast<double>(world.view().counts().stalled), 0.1 * static_cast<double>(world.robots()));
  if (test::k_slow_build) return;
  EXPECT_GT(engine::mean_displacement(world), 1.5);
  // Stage's hospital: 34.
  const std::size_t edges = median_edges_near_robots(world, 2);
  EXPECT_GE(edges, 25u);
  EXPECT_LE(edges, 45u);
}

// The check above finds what it looks for.
TEST(Hospital, TheCheckFindsRobotsInWallsAndInEachOther) {
  const engine::Registry registry = make_registry();
  Diagnostics diagnostics;
  worldio::LoadOptions options;
  options.robots = {{"", 3}};
  engine::WorldSpec spec =
      worldio::load_world(test::source_dir() / "worlds" / "hospital.json", registry, options, diagnostics);
  diagnostics.throw_if_errors();
  const std::size_t last = spec.bodies.size() - 1;
  spec.bodies[last - 2].pose_world_body.x = -70 + 0.05;  // the outer wall
  spec.bodies[last - 1].pose_world_body = spec.bodies[last].pose_world_body;
  spec.bodies[last - 1].pose_world_body.y += 0.15;
  engine::World world(std::move(spec), registry, {}, diagnostics);
  const Overlaps found = overlaps(world);
  EXPECT_EQ(found.with_walls, 1u);
  EXPECT_EQ(found.with_each_other, 1u);
}

}  // namespace
}  // namespace troupe::hospital_test
