#include "partition/nearby_outlines.hpp"

#include "base/random.hpp"
#include "tests/support/slow_build.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace troupe::partition::nearby_outlines_test {
namespace {

constexpr std::uint32_t k_thrift = test::k_slow_build ? 10 : 1;

template <class Visit>
void for_each_edge(std::span<const Vec2> chain, Visit&& visit) {
  for (std::size_t i = 1; i < chain.size(); ++i) visit(chain[i - 1], chain[i]);
}

double distance(const Vec2& p, const FixedEdge& edge) {
  const Vec2 along = edge.b - edge.a;
  const double t = std::clamp((p - edge.a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (edge.a + t * along - p).norm();
}

struct Scene {
  std::vector<Transform> places;
  std::vector<double> radii;
  std::vector<FixedEdge> edges;
};

/// Bodies of all sizes, and outlines of short, long and very long edges.
Scene any_scene(Random& random) {
  Scene scene;
  for (std::uint32_t i = 0, n = random.below(400); i < n; ++i) {
    scene.places.emplace_back(Pose{random.uniform(-10, 10), random.uniform(-10, 10), 0, 0});
    scene.radii.push_back(random.below(40) ? random.uniform(0.01, 0.1) : random.uniform(0.1, 4));
  }
  for (std::uint32_t solid = 0; solid < 5; ++solid) {
    Vec2 at(random.uniform(-10, 10), random.uniform(-10, 10));
    const double step = random.below(2) ? 0.1 : random.below(2) ? 2 : 30;
    for (std::uint32_t i = 0, n = 1 + random.below(60); i < n; ++i) {
      const Vec2 next = at + Vec2(random.uniform(-step, step), random.uniform(-step, step));
      scene.edges.push_back({at, next, solid});
      at = next;
    }
  }
  return scene;
}

TEST(NearbyOutlines, BandsHoldAllThatComesNearAndPaddingNothing) {
  Parallel parallel(1);
  std::size_t found = 0;
  NearbyOutlines
      outlines;  // must not keep anything of the scenes before, whose indexes had the same addresses
  for (std::uint32_t trial = 0; trial < 400 / k_thrift; ++trial) {
    Random random(1, 1, 0, trial);
    const Scene scene = any_scene(random);
    const GridGeometry grid{random.uniform(0.05, 3), random.below(6)};
    BodyIndex bodies(grid);
    bodies.rebuild(scene.places, scene.radii, parallel);
    const FixedOutlines fixed(scene.edges, random.uniform(0.05, 5));
    const double reach = random.below(2) ? 3 : random.uniform(0.1, 6);
    Vec2 eye(0, 0);  // of the first look of every scene, so that all of them start in similar blocks
    for (int look = 0; look < 5; ++look) {
      outlines.begin(bodies, fixed, reach);
      outlines.set_block_of(eye);
      std::set<std::uint32_t> rows;
      std::vector<bool> edges(scene.edges.size());
      outlines.band(0);
      const std::size_t bands = 1 + random.below(static_cast<std::uint32_t>(outlines.bands()));
      for (std::size_t b = 0; b < bands; ++b) {
        const NearbyOutlines::Band band = outlines.band(b);
        ASSERT_EQ((band.end - band.begin) % 16, 0u);
        for (std::size_t i = band.begin; i < band.end; ++i) {
          if (outlines.circles().radius[i] < 0) continue;  // padding
          const std::uint32_t row = outlines.circles().row[i];
          if (row < NearbyOutlines::k_fixed)
            rows.insert(row);
          else
            for_each_edge(fixed.chain(row - NearbyOutlines::k_fixed), [&](const Vec2& from, const Vec2& to) {
              for (std::size_t k = 0; k < scene.edges.size(); ++k)
                if (scene.edges[k].a == from && scene.edges[k].b == to) edges[k] = true;
            });
        }
        const double near = outlines.radius(b);
        for (std::uint32_t r = 0; r < scene.places.size(); ++r) {
          if ((scene.places[r].position - eye).norm() - scene.radii[r] > near) continue;
          ASSERT_TRUE(rows.contains(r)) << "trial " << trial << ", band " << b << ", row " << r;
          ++found;
        }
        for (std::size_t k = 0; k < scene.edges.size(); ++k) {
          if (distance(eye, scene.edges[k]) > near) continue;
          ASSERT_TRUE(edges[k]) << "trial " << trial << ", band " << b << ", edge " << k;
          ++found;
        }
      }
      EXPECT_TRUE(outlines.nearest_shell_m() <= outlines.radius(0) || std::isinf(outlines.nearest_shell_m()));
      if (outlines.bands() > 1) {
        EXPECT_GE(outlines.band(0).end, NearbyOutlines::k_least_in_band_0);
      }
      if (look % 2 == 0)
        eye = Vec2(random.uniform(-10, 10), random.uniform(-10, 10));  // otherwise looks again
    }
  }
  EXPECT_GT(found, 10000u / k_thrift);
}

TEST(NearCircles, HoldEachBodyOnceAndAllThatReachIntoTheDisc) {
  Parallel parallel(1);
  NearCircles near;
  std::size_t found = 0;
  for (std::uint32_t trial = 0; trial < 400 / k_thrift; ++trial) {
    Random random(1, 2, 0, trial);
    const Scene scene = any_scene(random);
    BodyIndex bodies(GridGeometry{random.uniform(0.05, 3), random.below(6)});
    bodies.rebuild(scene.places, scene.radii, parallel);
    const FixedOutlines fixed(scene.edges, random.uniform(0.05, 5));
    const Vec2 eye(random.uniform(-10, 10), random.uniform(-10, 10));
    const double reach = random.uniform(0.1, 6);
    near.begin(eye, reach);
    near.add_bodies(bodies, [](std::uint32_t row) { return row % 7 == 3; });
    const std::span<const std::uint32_t> list(near.circles().row.data(), near.size());
    const std::set<std::uint32_t> rows(list.begin(), list.end());
    ASSERT_EQ(rows.size(), near.size()) << "a body twice, trial " << trial;
    for (std::uint32_t r = 0; r < scene.places.size(); ++r) {
      const double gap = (scene.places[r].position - eye).norm() - scene.radii[r];
      if (gap <= reach) {
        ASSERT_EQ(rows.contains(r), r % 7 != 3) << "trial " << trial << ", row " << r;
        ++found;
      } else if (gap > reach + 1e-3) {
        ASSERT_FALSE(rows.contains(r)) << "trial " << trial << ", row " << r;
      }
    }
    const std::size_t count = near.size();
    near.add_pieces(fixed, reach, 1u << 31);
    std::vector<bool> edges(scene.edges.size());
    for (std::size_t i = count; i < near.size(); ++i) {
      ASSERT_NE(near.circles().row[i] & 1u << 31, 0u);
      for_each_edge(fixed.chain(near.circles().row[i] & ~(1u << 31)), [&](const Vec2& from, const Vec2& to) {
        for (std::size_t k = 0; k < scene.edges.size(); ++k)
          if (scene.edges[k].a == from && scene.edges[k].b == to) edges[k] = true;
      });
    }
    for (std::size_t k = 0; k < scene.edges.size(); ++k)
      if (distance(eye, scene.edges[k]) <= reach) {
        ASSERT_TRUE(edges[k]) << "trial " << trial << ", edge " << k;
        ++found;
      }
  }
  EXPECT_GT(found, 2000u / k_thrift);
}

TEST(NearCircles, AWideBodyInSeveralCellsIsAddedOnce) {
  Parallel parallel(1);
  std::vector<Transform> places;
  std::vector<double> radii;
  for (int i = 0; i < 30; ++i) {
    places.emplace_back(Pose{0.2 * i - 3, 0.1 * i - 1.5, 0, 0});
    radii.push_back(i % 3 == 0 ? 1.3 : 0.1);  // every third one is in many cells
  }
  BodyIndex bodies(GridGeometry{0.3, 2});
  bodies.rebuild(places, radii, parallel);
  NearCircles near;
  near.begin({0, 0}, 6);
  std::vector<int> asked(places.size());
  near.add_bodies(bodies, [&](std::uint32_t row) { return ++asked.at(row) > 1; });
  EXPECT_EQ(near.size(), places.size());
  EXPECT_EQ(asked, std::vector<int>(places.size(), 1));
}

TEST(FixedOutlines, CirclesOfAPieceCoverItsEdges) {
  for (std::uint32_t trial = 0; trial < 200 / k_thrift; ++trial) {
    Random random(1, 2, 0, trial);
    const Scene scene = any_scene(random);
    const FixedOutlines fixed(scene.edges, random.uniform(0.05, 5));
    const GridGeometry& grid = fixed.geometry();
    std::vector<BodyCircle> circles;
    const Cell low = grid.cell({-5000, -5000}), high = grid.cell({5000, 5000});
    fixed.for_each_run(low, high, [&](std::span<const BodyCircle> run) {
      circles.insert(circles.end(), run.begin(), run.end());
    });
    std::size_t edges = 0;
    std::set<std::uint32_t> pieces;
    for (const BodyCircle& c : circles) {
      EXPECT_LE(c.radius, fixed.largest_radius() * 1.00001 + 1e-4);
      if (pieces.insert(c.row).second) edges += fixed.chain(c.row).size() - 1;
    }
    ASSERT_EQ(edges, scene.edges.size()) << "trial " << trial;
    for (const std::uint32_t piece : pieces) {
      for_each_edge(fixed.chain(piece), [&](const Vec2& from, const Vec2& to) {
        for (int i = 0; i <= 20; ++i) {
          const Vec2 p = from + i / 20.0 * (to - from);
          ASSERT_TRUE(std::ranges::any_of(
              circles,
              [&](const BodyCircle& c) { return c.row == piece && (Vec2(c.x, c.y) - p).norm() <= c.radius; }))
              << "trial " << trial;
        }
      });
    }
  }
}

}  // namespace
}  // namespace troupe::partition::nearby_outlines_test
