#include "partition/static_scene.hpp"

#include "tests/engine/conflict_crowds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <span>
#include <utility>
#include <vector>

namespace troupe::partition::static_scene_test {
namespace {

using oracle::Draw;
using oracle::rectangle;

/// A scene of floor plans with holes and islands in them, blocks, planks, and solids that block no body.
std::vector<FixedSolid> random_solids(Draw& draw) {
  std::vector<FixedSolid> solids;
  const std::size_t count = 1 + draw.below(8);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 at(draw.real(-5, 5), draw.real(-5, 5));
    Solid solid{{}, draw.chance(0.7) ? ZInterval{0, 1} : ZInterval{0.5, 2}};
    switch (draw.below(4)) {
      case 0:
        solid.contours = {oracle::turned(rectangle(0, 0, draw.scale(0.2, 12), 0.02), draw.real(0, 6), at)};
        break;
      case 1:
        solid.contours = {oracle::turned(oracle::random_star(draw, 9, draw.scale(0.3, 4), 0.3), 0, at)};
        break;
      case 2: {
        const double r = draw.scale(0.5, 6);
        solid.contours = {oracle::turned(rectangle(-r, -r, r, r), 0, at),
                          oracle::turned(oracle::random_star(draw, 7, 0.9 * r, 0.6), 0, at),
                          oracle::turned(oracle::random_star(draw, 5, 0.4 * r, 0.6), 0, at)};
        break;
      }
      default:
        solid.contours = {
            rectangle(at.x(), at.y(), at.x() + draw.scale(0.1, 3), at.y() + draw.scale(0.1, 3))};
    }
    // Two solids may belong to one body.
    solids.push_back(
        {std::move(solid), BodyId(3 + i / 2), draw.chance(0.8), draw.chance(0.8) ? 1.0f : -1.0f});
  }
  return solids;
}

TEST(StaticScene, AnswersAsTheOracleWhateverItsCells) {
  std::size_t blocked = 0;
  std::size_t swallowed = 0;
  std::size_t asked = 0;
  for (std::uint64_t seed = 1; seed <= 1500 / oracle::k_thrift; ++seed) {
    Draw draw(seed);
    const std::vector<FixedSolid> solids = random_solids(draw);
    std::vector<oracle::Blocks> placed;
    for (const FixedSolid& fixed : solids) placed.push_back(oracle::place({fixed.solid}, {}));
    const std::array<StaticScene, 3> scenes{StaticScene(solids, 0.1), StaticScene(solids, 0.9),
                                            StaticScene(solids, 20)};
    const oracle::Kind kind = oracle::random_kind(draw, draw.scale(0.05, 3));
    for (int i = 0; i < 20; ++i) {
      const Pose pose{draw.real(-5, 5), draw.real(-5, 5), draw.real(-0.5, 0.8), draw.real(-4, 4)};
      const oracle::Blocks body = oracle::place(kind.body.blocks, pose);
      const PlacedShape there(kind.shape, pose);
      std::set<BodyId> met;
      std::vector<bool> overlaps;
      for (std::size_t s = 0; s < solids.size(); ++s) {
        overlaps.push_back(solids[s].obstacle && oracle::overlap(body, placed[s]));
        if (overlaps.back()) met.insert(solids[s].body);
      }
      for (const StaticScene& scene : scenes) {
        ASSERT_EQ(scene.blocked(kind.shape, pose), !met.empty()) << "seed " << seed;
        for (std::uint32_t s = 0; s < solids.size(); ++s)
          ASSERT_EQ(scene.overlaps_solid(s, there), overlaps[s]) << "seed " << seed << ", solid " << s;
        const std::vector<BodyId> expected(met.begin(), met.end());
        ASSERT_EQ(scene.overlapping(kind.shape, pose), expected) << "seed " << seed;

        // crossed() finds a solid that overlaps the shape, unless this solid is ignored.
        const int hit = scene.crossed(there, [](std::uint32_t) { return false; });
        ASSERT_TRUE(hit < 0 || overlaps[static_cast<std::size_t>(hit)]) << "seed " << seed;
        ASSERT_EQ(scene.crossed(there, [&](std::uint32_t s) { return overlaps[s]; }), -1) << "seed " << seed;
        if (hit >= 0) {
          const auto all_but = [&](std::uint32_t s) { return s != static_cast<std::uint32_t>(hit); };
          ASSERT_EQ(scene.crossed(there, all_but), hit) << "seed " << seed;
        } else if (!met.empty()) {
          ++swallowed;
        }
      }
      ++asked;
      blocked += !met.empty();
    }
  }
  EXPECT_GT(blocked, asked / 20);
  EXPECT_LT(blocked, asked * 9 / 10);
  EXPECT_GT(swallowed, 100 / oracle::k_thrift) << "few bodies lay wholly inside a solid";
}

TEST(StaticScene, FindsEachSolidWhoseBoxContainsAPointOnce) {
  std::size_t found = 0;
  for (std::uint64_t seed = 1; seed <= 200 / oracle::k_thrift; ++seed) {
    Draw draw(9'000'000 + seed);
    const std::vector<FixedSolid> solids = random_solids(draw);
    const StaticScene scene(solids, draw.scale(0.1, 5));
    for (int i = 0; i < 20; ++i) {
      const Vec2 point(draw.real(-6, 6), draw.real(-6, 6));
      std::vector<int> visits(solids.size());
      scene.for_each_box_at(point, [&](std::uint32_t s) { ++visits.at(s); });
      for (std::size_t s = 0; s < solids.size(); ++s) {
        Box box;
        for (const Ring& ring : solids[s].solid.contours) box.extend(bounds(ring));
        ASSERT_EQ(visits[s], box.contains(point) ? 1 : 0) << "seed " << seed << ", solid " << s;
        found += box.contains(point);
      }
    }
  }
  EXPECT_GT(found, 500 / oracle::k_thrift);
}

TEST(StaticScene, ABodyOfManyVerticesMeetsWhatTheOracleSays) {
  std::size_t blocked = 0;
  constexpr std::size_t k_poses = 300 / oracle::k_thrift;
  for (std::uint64_t seed = 1; seed <= k_poses; ++seed) {
    Draw draw(7'000'000 + seed);
    const oracle::Kind kind =
        oracle::make_kind({{{oracle::random_star(draw, 80 + draw.below(60), 1, 0.5)}, {0, 0.5}}});
    ASSERT_GT(kind.shape.vertices, 128u);
    const Solid wall{{oracle::random_star(draw, 9, 1.5, 0.3)}, {0, 1}};
    const StaticScene scene({{wall, BodyId(1), true, 1}}, draw.scale(0.1, 3));
    const Pose pose{draw.real(-2, 2), draw.real(-2, 2), 0, draw.real(-4, 4)};
    const bool expected = oracle::overlap(oracle::place(kind.body.blocks, pose), oracle::place({wall}, {}));
    ASSERT_EQ(scene.blocked(kind.shape, pose), expected) << "seed " << seed;
    blocked += expected;
  }
  EXPECT_GT(blocked, k_poses / 10);
  EXPECT_LT(blocked, k_poses * 9 / 10);
}

TEST(StaticScene, ClearanceIsTheDistanceToTheNearestObstacleEdge) {
  for (std::uint64_t seed = 1; seed <= 100 / oracle::k_thrift; ++seed) {
    Draw draw(8'000'000 + seed);
    std::vector<FixedSolid> solids;
    for (std::size_t s = draw.below(12); s > 0; --s) {
      Solid star{{oracle::random_star(draw, 7, draw.scale(0.1, 3), 0.4)}, {0, 1}};
      const Vec2 by(draw.real(-10, 10), draw.real(-10, 10));
      for (Vec2& v : star.contours[0]) v += by;
      solids.push_back({std::move(star), BodyId(s), draw.chance(0.8), 1});
    }
    const StaticScene scene(solids, draw.scale(0.1, 5));
    for (int i = 0; i < 50; ++i) {
      const Vec2 p(draw.real(-12, 12), draw.real(-12, 12));
      const double most = draw.scale(0.05, 10);
      double expected = most;
      for (const FixedSolid& fixed : solids) {
        if (!fixed.obstacle) continue;
        const Ring& ring = fixed.solid.contours[0];
        for (std::size_t k = 0; k < ring.size(); ++k) {
          const Vec2 a = ring[k];
          const Vec2 along = ring[(k + 1) % ring.size()] - a;
          const double t = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
          expected = std::min(expected, (p - a - t * along).norm());
        }
      }
      ASSERT_NEAR(scene.clearance(p, most), expected, 1e-12) << "seed " << seed;
    }
  }
}

TEST(StaticScene, ABodyInAHoleIsFree) {
  const Solid plan{
      {rectangle(-10, -10, 10, 10), rectangle(-1, -1, 1, 1), rectangle(-0.125, -0.125, 0.125, 0.125)},
      {0, 1}};
  const StaticScene scene({{plan, BodyId(1), true, 1}}, 0.5);
  const oracle::Kind body = oracle::make_kind({{{rectangle(-0.25, -0.25, 0.25, 0.25)}, {0, 0.5}}});
  EXPECT_FALSE(scene.blocked(body.shape, {0.5, 0.5, 0, 0}));
  EXPECT_FALSE(scene.blocked(body.shape, {0.75, 0.75, 0, 0})) << "touching is free";
  EXPECT_TRUE(scene.blocked(body.shape, {0.8, 0.75, 0, 0}));
  EXPECT_TRUE(scene.blocked(body.shape, {5, 5, 0, 0}));
  EXPECT_TRUE(scene.blocked(body.shape, {0, 0, 0, 0})) << "around the pillar";
  EXPECT_FALSE(scene.blocked(body.shape, {0, 0, 1, 0})) << "on top of it";
  EXPECT_FALSE(scene.blocked(body.shape, {50, 0, 0, 0}));
  // Far inside no edge is near.
  EXPECT_EQ(scene.crossed(PlacedShape(body.shape, Pose{5, 5, 0, 0}), [](std::uint32_t) { return false; }),
            -1);
}

TEST(StaticScene, ABodyThatFillsAHoleTouchesOnAllSides) {
  const Solid plan{{rectangle(-4, -4, 4, 4), rectangle(-1, -1, 1, 1)}, {0, 1}};
  const StaticScene scene({{plan, BodyId(1), true, 1}}, 0.5);
  const oracle::Kind plug = oracle::make_kind({{{rectangle(-1, -1, 1, 1)}, {0, 1}}});
  EXPECT_FALSE(scene.blocked(plug.shape, {}));
  const StaticScene block({{{{rectangle(-1, -1, 1, 1)}, {0, 1}}, BodyId(1), true, 1}}, 0.5);
  EXPECT_TRUE(block.blocked(plug.shape, {})) << "the same ground, edge on edge";
}

TEST(StaticScene, WithoutSolidsBlocksNothing) {
  const oracle::Kind body = oracle::make_kind({{{rectangle(-1, -1, 1, 1)}, {0, 1}}});
  for (const StaticScene& scene :
       {StaticScene(), StaticScene({}, 1),
        StaticScene({{{{rectangle(-9, -9, 9, 9)}, {0, 1}}, BodyId(1), false, 1}}, 1)}) {
    EXPECT_FALSE(scene.has_obstacles());
    EXPECT_FALSE(scene.blocked(body.shape, {}));
    EXPECT_TRUE(scene.overlapping(body.shape, {}).empty());
  }
}

TEST(StaticScene, CountsItsEdgesAndBounds) {
  const StaticScene scene(
      {{{{rectangle(0, 0, 2, 1), rectangle(0.5, 0.25, 1, 0.5)}, {0, 1}}, BodyId(1), true, 1},
       {{{{{-3, 0}, {-2, 0}, {-2, 5}}}, {0, 1}}, BodyId(2), false, -1}},
      1);
  EXPECT_EQ(scene.edge_count(), 11u);
  EXPECT_EQ(scene.bounds().min, Vec2(-3, 0));
  EXPECT_EQ(scene.bounds().max, Vec2(2, 5));
}

// Long walls would cross more small cells than fit into memory. Larger cells answer in the same way.
TEST(StaticScene, LongWallsTakeLittleMemoryInSmallCells) {
  constexpr std::uint32_t k_walls = 1000;
  const auto pose_of = [](std::uint32_t wall) { return Pose{0, 2.0 * wall, 0, 0.5}; };
  std::vector<FixedSolid> solids;
  for (std::uint32_t w = 0; w < k_walls; ++w)
    solids.push_back(
        {{{oracle::turned(rectangle(-5e4, 0, 5e4, 0.5), pose_of(w).heading, pose_of(w).position())}, {0, 1}},
         BodyId(w)});
  const StaticScene scene(std::move(solids), 0.05);
  const oracle::Kind body = oracle::make_kind({{{rectangle(-0.1, -0.1, 0.1, 0.1)}, {0, 1}}});
  for (const std::uint32_t w : {0u, 500u, k_walls - 1})
    for (const double x : {-4e4, 0.0, 4e4}) {
      const auto at = [&](double y) {
        const Vec2 p = Transform(pose_of(w)) * Vec2(x, y);
        return Pose{p.x(), p.y(), 0, 0};
      };
      const std::vector<BodyId> wall{BodyId(w)};
      EXPECT_EQ(scene.overlapping(body.shape, at(0.25)), wall) << "inside";
      EXPECT_EQ(scene.overlapping(body.shape, at(0.5)), wall) << "on an edge";
      EXPECT_FALSE(scene.blocked(body.shape, at(0.8)));
      EXPECT_NEAR(scene.clearance(at(0.8).position(), 1), 0.3, 1e-9);
      bool seen = false;
      scene.outlines().for_each_run(Box::around(at(0.5).position(), 0.1),
                                    [&](std::span<const BodyCircle> run) {
                                      for (const BodyCircle& circle : run)
                                        seen = seen || scene.outlines().solid(circle.row) == w;
                                    });
      EXPECT_TRUE(seen);
    }
}

// The cells that tall obstacles cover would not fit into memory either.
TEST(StaticScene, ManyLargeObstaclesTakeLittleMemory) {
  constexpr std::uint32_t k_obstacles = 20'000;
  constexpr double k_shift = 0.01;
  std::vector<FixedSolid> solids;
  for (std::uint32_t i = 0; i < k_obstacles; ++i)
    solids.push_back({{{rectangle(k_shift * i, 0, 255 + k_shift * i, 255)}, {0, 1}}, BodyId(i)});
  const StaticScene scene(std::move(solids), 0.25);
  const oracle::Kind body = oracle::make_kind({{{rectangle(-0.001, -0.001, 0.001, 0.001)}, {0, 1}}});
  const auto overlapping = [&](double x) { return scene.overlapping(body.shape, {x, 100, 0, 0}); };
  EXPECT_TRUE(overlapping(-0.5 * k_shift).empty());
  EXPECT_EQ(overlapping(0.5 * k_shift), std::vector{BodyId(0)});
  EXPECT_EQ(overlapping(100.5 * k_shift).size(), 101u);
  EXPECT_EQ(overlapping(200).size(), k_obstacles);
  EXPECT_EQ(overlapping(255 + (k_obstacles - 1.5) * k_shift), std::vector{BodyId(k_obstacles - 1)});
}

// A search finds each edge that touches its box, whatever the size of the cells.
TEST(EdgeGrid, FindsEveryEdgeThatMeetsABox) {
  for (std::uint64_t seed = 1; seed <= 300 / oracle::k_thrift; ++seed) {
    Draw draw(seed);
    std::vector<FixedEdge> edges;
    const double far = draw.chance(0.2) ? 9e4 : 0;
    const auto point = [&] {
      Vec2 p(draw.real(-20, 20), draw.real(-20, 20));
      if (draw.chance(0.3)) p = p.array().round();
      return Vec2(p + Vec2(far, far));
    };
    for (std::uint32_t e = 0; e < 60; ++e) {
      FixedEdge edge{point(), point(), e};
      if (draw.chance(0.3))
        edge.b.x() = edge.a.x();  // along the borders of cells, some of them
      else if (draw.chance(0.3))
        edge.b.y() = edge.a.y();
      edges.push_back(edge);
    }
    for (const double cell : {0.25, 1.0, 3.3, 100.0}) {
      const EdgeGrid grid(edges, {cell, 3});
      for (int q = 0; q < 20; ++q) {
        const Box box = Box::around(point(), draw.scale(0.01, 5));
        std::vector<bool> found(edges.size());
        grid.for_each_run(box, [&](std::span<const FixedEdge> run) {
          for (const FixedEdge& edge : run) {
            found[edge.solid] = true;
            ASSERT_EQ(edge.a, edges[edge.solid].a) << "edges are never clipped";
            ASSERT_EQ(edge.b, edges[edge.solid].b);
          }
        });
        const Ring corners = rectangle(box.min.x(), box.min.y(), box.max.x(), box.max.y());
        for (const FixedEdge& edge : edges)
          ASSERT_TRUE(found[edge.solid] || !segment_overlap(edge.a, edge.b, corners))
              << "edge " << edge.solid << ", cells of " << cell << " m, seed " << seed;
      }
    }
  }
}

}  // namespace
}  // namespace troupe::partition::static_scene_test
