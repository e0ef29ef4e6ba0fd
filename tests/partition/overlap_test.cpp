#include "partition/overlap.hpp"

#include "partition/placed_shape.hpp"
#include "tests/engine/conflict_crowds.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <vector>

namespace troupe::partition::overlap_test {
namespace {

using oracle::Draw;
using oracle::rectangle;

oracle::Region region_of(const std::vector<Ring>& rings) {
  oracle::Region region;
  for (const Ring& ring : rings) {
    std::vector<oracle::Point> points;
    for (const Vec2& v : ring) points.push_back(oracle::lattice_point(v.x(), v.y()));
    region.add(points);
  }
  return region;
}

Ring moved(Ring ring, double x, double y) {
  for (Vec2& v : ring) v += Vec2(x, y);
  return ring;
}

// The results of the oracle in cases that a reader can check by eye. All coordinates are sums of powers of
// two, so they are exact.
TEST(Oracle, KnowsTouchingFromSharing) {
  const Ring square = rectangle(0, 0, 1, 1);
  const auto share = [](const std::vector<Ring>& a, const std::vector<Ring>& b) {
    const bool answer = oracle::share_area(region_of(a), region_of(b));
    EXPECT_EQ(answer, oracle::share_area(region_of(b), region_of(a)));
    return answer;
  };
  EXPECT_TRUE(share({square}, {square}));
  EXPECT_TRUE(share({square}, {moved(square, 0.5, 0)}));            // edges along one line
  EXPECT_TRUE(share({square}, {rectangle(0, 0, 0.5, 1)}));          // inside, along three sides
  EXPECT_TRUE(share({square}, {rectangle(0.25, 0.25, 0.5, 0.5)}));  // wholly inside
  EXPECT_TRUE(share({square}, {{{0, 0}, {1, 0}, {0, 1}}}));         // half of it
  EXPECT_TRUE(
      share({square}, {{{0.5, 0}, {1, 0.5}, {0.5, 1}, {0, 0.5}}}));  // corners on the edges, from inside
  EXPECT_FALSE(share({square}, {moved(square, 1, 0)}));              // side by side
  EXPECT_FALSE(share({square}, {moved(square, 1, 1)}));              // corner to corner
  EXPECT_FALSE(share({square}, {moved(square, 1, 0.5)}));
  EXPECT_FALSE(share({square}, {{{1, 0.5}, {2, 0}, {2, 1}}}));  // a corner on an edge, from outside
  EXPECT_FALSE(share({square}, {moved(square, 3, 0)}));
  const std::vector<Ring> frame{rectangle(-1, -1, 2, 2), square};
  EXPECT_FALSE(share({square}, frame));  // fills the hole
  EXPECT_FALSE(share({rectangle(0.25, 0.25, 0.5, 0.5)}, frame));
  EXPECT_TRUE(share({rectangle(0.25, 0.25, 1.5, 0.5)}, frame));
  EXPECT_TRUE(share({rectangle(-2, -2, 3, 3)}, frame));
  EXPECT_TRUE(share({rectangle(-1, -1, 2, 2)}, frame));
  EXPECT_TRUE(share({rectangle(-1, -1, 0, 2)}, frame));
}

TEST(Overlap, ConvexPolygonsAsTheOracleSays) {
  std::uint64_t shared = 0;
  constexpr std::uint64_t k_pairs = 100'000 / oracle::k_thrift;
  for (std::uint64_t seed = 1; seed <= k_pairs; ++seed) {
    Draw draw(seed);
    const Ring a = oracle::random_star(draw, 3 + draw.below(6), draw.scale(0.01, 3), 1);
    const Ring b = moved(oracle::random_star(draw, 3 + draw.below(6), draw.scale(0.01, 3), 1),
                         draw.real(-2, 2), draw.real(-2, 2));
    const bool expected = oracle::share_area(region_of({a}), region_of({b}));
    ASSERT_EQ(convex_overlap(a, b), expected) << "seed " << seed;
    ASSERT_EQ(convex_overlap(b, a), expected) << "seed " << seed;
    shared += expected;
  }
  EXPECT_GT(shared, k_pairs / 10);
  EXPECT_LT(shared, k_pairs * 9 / 10);
}

// A needle in place of the segment: it shares area with the polygon where the segment enters it.
TEST(Overlap, SegmentsAsTheOracleSays) {
  std::uint64_t shared = 0;
  constexpr std::uint64_t k_pairs = 100'000 / oracle::k_thrift;
  for (std::uint64_t seed = 1; seed <= k_pairs; ++seed) {
    Draw draw(seed);
    const Ring polygon = oracle::random_star(draw, 3 + draw.below(6), draw.scale(0.01, 3), 1);
    const Vec2 a(draw.real(-2, 2), draw.real(-2, 2));
    const Vec2 b(draw.real(-2, 2), draw.real(-2, 2));
    const Vec2 side = 1e-12 * Vec2(-(b - a).y(), (b - a).x()).normalized();
    const bool expected = oracle::share_area(region_of({polygon}), region_of({{a, b, b + side, a + side}}));
    ASSERT_EQ(segment_overlap(a, b, polygon), expected) << "seed " << seed;
    ASSERT_EQ(segment_overlap(b, a, polygon), expected) << "seed " << seed;
    shared += expected;
  }
  EXPECT_GT(shared, k_pairs / 10);
  EXPECT_LT(shared, k_pairs * 9 / 10);
}

TEST(Overlap, SegmentsThatTouchDoNotEnter) {
  const Ring square = rectangle(0, 0, 1, 1);
  EXPECT_FALSE(segment_overlap({0, 0}, {1, 0}, square));           // its own edge
  EXPECT_FALSE(segment_overlap({-1, 1}, {2, 1}, square));          // along an edge
  EXPECT_FALSE(segment_overlap({-1, 1}, {1, 3}, square));          // past the corner
  EXPECT_FALSE(segment_overlap({-0.5, 0.5}, {0.5, 1.5}, square));  // through the corner
  EXPECT_FALSE(segment_overlap({-1, 0.5}, {0, 0.5}, square));      // ends on an edge
  EXPECT_TRUE(segment_overlap({-1, 0.5}, {0.25, 0.5}, square));
  EXPECT_TRUE(segment_overlap({0, 0}, {1, 1}, square));  // a diagonal
  EXPECT_TRUE(segment_overlap({0.25, 0.25}, {0.5, 0.5}, square));
}

// If a corner is cut off very close to its vertex, an edge remains that is so short that the rounding of its
// ends determines its direction. The line of such an edge must not separate its polygon from another one.
TEST(Overlap, EdgesShorterThanTheirRoundingSeparateNoBodies) {
  for (const double far : {0.0, 10.0, 1e3, 1e5}) {
    for (const double length : {0.0, 1e-17, 1e-16, 1e-14, 1e-12, 1e-10}) {
      for (int turn = 0; turn < 64; ++turn) {
        const double angle = turn * k_pi / 32;
        Ring corner = rectangle(-0.5, -0.5, 0.5, 0.5);
        corner.insert(corner.begin() + 2, {{0.5 + 0.5 * length, 0.5 - length}});
        Ring body = oracle::turned(corner, angle, {far, -far});
        Ring dot = oracle::turned(rectangle(-0.01, -0.01, 0.01, 0.01), angle, Vec2(far, -far));
        for (const Vec2& at :
             {Vec2(0, 0), Vec2(0.45, 0.45), Vec2(-0.45, 0.45), Vec2(0.45, -0.45), Vec2(-0.45, -0.45)}) {
          const Vec2 by = oracle::turned({at}, angle).front();
          const Ring there = moved(dot, by.x(), by.y());
          EXPECT_TRUE(convex_overlap(body, there)) << far << ' ' << length << ' ' << turn;
          EXPECT_TRUE(convex_overlap(there, body)) << far << ' ' << length << ' ' << turn;
          EXPECT_TRUE(segment_overlap(there[0], there[2], body)) << far << ' ' << length << ' ' << turn;
        }
        const Vec2 by = oracle::turned({{0.52, 0.3}}, angle).front();
        EXPECT_FALSE(convex_overlap(body, moved(dot, by.x(), by.y()))) << far << ' ' << length << ' ' << turn;
      }
    }
  }
}

TEST(Overlap, BodiesAsTheOracleSays) {
  std::uint64_t shared = 0;
  constexpr std::uint64_t k_pairs = 20'000 / oracle::k_thrift;
  for (std::uint64_t seed = 1; seed <= k_pairs; ++seed) {
    Draw draw(seed);
    const oracle::Kind a = oracle::random_kind(draw, draw.scale(0.05, 3));
    const oracle::Kind b = oracle::random_kind(draw, draw.scale(0.05, 3));
    const Pose at{draw.real(-1, 1), draw.real(-1, 1), draw.real(-0.5, 0.5), draw.real(-9, 9)};
    const Pose there{draw.real(-1, 1), draw.real(-1, 1), draw.real(-0.5, 0.5), draw.real(-9, 9)};
    const bool expected =
        oracle::overlap(oracle::place(a.body.blocks, at), oracle::place(b.body.blocks, there));
    ASSERT_EQ(overlap(a.shape, at, b.shape, there), expected) << "seed " << seed;
    ASSERT_EQ(overlap(b.shape, there, a.shape, at), expected) << "seed " << seed;
    ASSERT_TRUE(!expected || pieces_in_reach(a.shape, Transform(at), b.shape, Transform(there), 0))
        << "seed " << seed;
    shared += expected;
  }
  EXPECT_GT(shared, k_pairs / 10);
  EXPECT_LT(shared, k_pairs * 9 / 10);
}

// Shapes with more vertices than a PlacedShape stores.
TEST(Overlap, BodiesOfManyVerticesAsTheOracleSays) {
  std::size_t shared = 0;
  constexpr std::size_t k_pairs = 400 / oracle::k_thrift;
  for (std::uint64_t seed = 1; seed <= k_pairs; ++seed) {
    Draw draw(6'000'000 + seed);
    const oracle::Kind a =
        oracle::make_kind({{{oracle::random_star(draw, 80 + draw.below(60), 1, 0.5)}, {0, 0.5}}});
    const oracle::Kind b = draw.chance(0.5)
                               ? oracle::make_kind({{{rectangle(-0.3, -0.2, 0.3, 0.2)}, {0, 0.5}}})
                               : oracle::make_kind({{{oracle::random_star(draw, 100, 0.8, 0.7)}, {0, 0.5}}});
    ASSERT_GT(a.shape.vertices, 128u);
    const Pose at{draw.real(-1, 1), draw.real(-1, 1), 0, draw.real(-9, 9)};
    const Pose there{draw.real(-1, 1), draw.real(-1, 1), 0, draw.real(-9, 9)};
    const bool expected =
        oracle::overlap(oracle::place(a.body.blocks, at), oracle::place(b.body.blocks, there));
    ASSERT_EQ(overlap(a.shape, at, b.shape, there), expected) << "seed " << seed;
    ASSERT_EQ(overlap(b.shape, there, a.shape, at), expected) << "seed " << seed;
    shared += expected;
  }
  EXPECT_GT(shared, k_pairs / 10);
  EXPECT_LT(shared, k_pairs * 9 / 10);
}

TEST(Overlap, HeightsThatOnlyTouchDoNot) {
  const oracle::Kind low = oracle::make_kind({{{rectangle(-1, -1, 1, 1)}, {0, 0.5}}});
  EXPECT_TRUE(overlap(low.shape, {}, low.shape, {0.5, 0, 0.25, 0}));
  EXPECT_FALSE(overlap(low.shape, {}, low.shape, {0.5, 0, 0.5, 0}));
  EXPECT_FALSE(overlap(low.shape, {0, 0, 0.5, 0}, low.shape, {0.5, 0, 0, 0}));
}

TEST(Overlap, ABodyWithoutSolidsMeetsNoBody) {
  const oracle::Kind square = oracle::make_kind({{{rectangle(-1, -1, 1, 1)}, {0, 0.5}}});
  const ObstacleShape nothing = make_obstacle_shape({});
  EXPECT_TRUE(nothing.empty());
  EXPECT_FALSE(overlap(nothing, {}, square.shape, {}));
  EXPECT_FALSE(overlap(square.shape, {}, nothing, {}));
}

// At 100 km from the origin, where positions are rounded to 1.5e-11 m, the results are the same.
RC_GTEST_PROP(Overlap, DoesNotDependOnWhereTheWorldLies, (int x, int y)) {
  const oracle::Kind square = oracle::make_kind({{{rectangle(-0.25, -0.25, 0.25, 0.25)}, {0, 0.5}}});
  const double far_x = x % 100'000;
  const double far_y = y % 100'000;
  RC_ASSERT(overlap(square.shape, {far_x, far_y, 0, 0}, square.shape, {far_x + 0.5 - 0x1p-20, far_y, 0, 0}));
  RC_ASSERT(!overlap(square.shape, {far_x, far_y, 0, 0}, square.shape, {far_x + 0.5, far_y, 0, 0}));
}

TEST(PiecesInReach, ComparesTheCirclesOfThePieces) {
  const ObstacleShape fork = make_obstacle_shape(
      std::vector<ConvexPrism>{{rectangle(-3, -4, 3, 4), {0, 1}}, {rectangle(97, -4, 103, 4), {0, 1}}});
  const ObstacleShape dot = make_obstacle_shape(std::vector<ConvexPrism>{{rectangle(-3, -4, 3, 4), {0, 1}}});
  const auto in_reach = [&](double x, double distance) {
    const Transform at(Pose{x, 0, 0, 0});
    EXPECT_EQ(pieces_in_reach(dot, at, fork, Transform(), distance),
              pieces_in_reach(fork, Transform(), dot, at, distance));
    return pieces_in_reach(fork, Transform(), dot, at, distance);
  };
  EXPECT_TRUE(in_reach(10, 0));  // the radii are 5 m
  EXPECT_FALSE(in_reach(10.01, 0));
  EXPECT_TRUE(in_reach(10.01, 0.01));
  EXPECT_FALSE(in_reach(50, 39.9)) << "between the pieces";
  EXPECT_TRUE(in_reach(50, 40.1));
  EXPECT_FALSE(pieces_in_reach(fork, {}, make_obstacle_shape({}), {}, 1000));
}

TEST(Inset, MovesEveryEdgeInwards) {
  const std::vector<ConvexPrism> pieces{{rectangle(-1, -2, 1, 2), {0.25, 1}},
                                        {{{3, 0}, {7, 0}, {3, 3}}, {0, 1}}};
  const ObstacleShape inner = inset(make_obstacle_shape(pieces), 0.5);
  ASSERT_EQ(inner.pieces.size(), 2u);
  EXPECT_EQ(inner.pieces[0].outline, rectangle(-0.5, -1.5, 0.5, 1.5));
  EXPECT_EQ(inner.pieces[0].z, (ZInterval{0.25, 1}));
  EXPECT_DOUBLE_EQ(inner.thinnest, 1);
  // The inner triangle has the same centre of the inscribed circle, (4, 1), and half its radius.
  const Ring& triangle = inner.pieces[1].outline;
  ASSERT_EQ(triangle.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_LT((triangle[i] - 0.5 * (pieces[1].outline[i] + Vec2(4, 1))).norm(), 1e-12) << i;
}

TEST(ObstacleShape, MeasuresItsPieces) {
  const std::vector<ConvexPrism> pieces{{rectangle(0, 0, 3, 1), {0, 0.5}},
                                        {rectangle(-4, -0.1, 0, 0.1), {0.5, 2}}};
  const ObstacleShape shape = make_obstacle_shape(pieces);
  EXPECT_DOUBLE_EQ(shape.radius, std::sqrt(16 + 0.01));
  EXPECT_DOUBLE_EQ(shape.thinnest, 0.2);
  EXPECT_EQ(shape.z, (ZInterval{0, 2}));
}

}  // namespace
}  // namespace troupe::partition::overlap_test
