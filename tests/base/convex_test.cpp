#include "base/geometry.hpp"
#include "base/random.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <vector>

namespace troupe::convex_test {
namespace {

Ring rectangle(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

Ring regular(int corners, double radius, double phase) {
  Ring ring;
  for (int i = 0; i < corners; ++i) {
    const SinCos s = sincos(phase + 2 * k_pi * i / corners);
    ring.emplace_back(radius * s.cos, radius * s.sin);
  }
  return ring;
}

Ring reversed(Ring ring) {
  std::reverse(ring.begin(), ring.end());
  return ring;
}

Ring turned(Ring ring, double angle) {
  const Rotation rotation(angle);
  for (Vec2& p : ring) p = rotation * p;
  return ring;
}

double total_area(const std::vector<ConvexPrism>& pieces) {
  return std::accumulate(pieces.begin(), pieces.end(), 0.0, [](double sum, const ConvexPrism& piece) {
    return sum + signed_area(piece.outline);
  });
}

double distance_to_edges(const std::vector<Ring>& rings, const Vec2& p) {
  double distance = std::numeric_limits<double>::infinity();
  for (const Ring& ring : rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vec2 a = ring[i];
      const Vec2 edge = ring[(i + 1) % ring.size()] - a;
      const double length2 = edge.squaredNorm();
      const double t = length2 > 0 ? std::clamp((p - a).dot(edge) / length2, 0.0, 1.0) : 0.0;
      distance = std::min(distance, (p - (a + t * edge)).norm());
    }
  }
  return distance;
}

/// Whether the point is inside by the even-odd rule, computed with another method than in the library: from
/// the number of turns that each contour makes about the point.
bool winds_oddly(const std::vector<Ring>& rings, const Vec2& p) {
  int turns = 0;
  for (const Ring& ring : rings) {
    double angle = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vec2 a = ring[i] - p;
      const Vec2 b = ring[(i + 1) % ring.size()] - p;
      angle += std::atan2(cross(a, b), a.dot(b));
    }
    turns += static_cast<int>(std::lround(angle / (2 * k_pi)));
  }
  return turns % 2 != 0;
}

bool in_convex(const Ring& ring, const Vec2& p) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (cross(ring[(i + 1) % ring.size()] - ring[i], p - ring[i]) < 0) return false;
  }
  return true;
}

/// Checks what the docstring of convex_pieces() promises, at random points. Returns the first promise that
/// does not hold, or an empty text.
std::string broken_promise(const Solid& solid, const std::vector<ConvexPrism>& pieces, std::uint32_t seed) {
  std::vector<Ring> all_edges = solid.contours;
  Box box;
  for (const Ring& ring : solid.contours) box.extend(bounds(ring));
  for (const ConvexPrism& piece : pieces) {
    if (!is_convex(piece.outline)) return "a piece is not convex";
    if (!(signed_area(piece.outline) > 0)) return "a piece is not counter-clockwise";
    if (piece.z != solid.z) return "a piece has another height";
    all_edges.push_back(piece.outline);
  }
  if (box.empty()) return "";
  Random random(seed, 0, 0, 0);
  const double margin = 1e-9 * (1 + box.size().maxCoeff());
  for (int i = 0; i < 400; ++i) {
    const Vec2 p(random.uniform(box.min.x() - 0.1, box.max.x() + 0.1),
                 random.uniform(box.min.y() - 0.1, box.max.y() + 0.1));
    if (distance_to_edges(all_edges, p) < margin) continue;
    const bool inside = winds_oddly(solid.contours, p);
    if (contains(solid, p) != inside) return "contains() is wrong";
    const auto holders = std::count_if(pieces.begin(), pieces.end(),
                                       [&](const ConvexPrism& piece) { return in_convex(piece.outline, p); });
    if (holders != (inside ? 1 : 0)) {
      return "a point lies in " + std::to_string(holders) + " pieces, inside: " + std::to_string(inside);
    }
  }
  return "";
}

constexpr ZInterval k_height = {0.25, 1.5};

void expect_exact_cover(const std::vector<Ring>& contours, double area, std::size_t at_most) {
  const Solid solid = {contours, k_height};
  const std::vector<ConvexPrism> pieces = convex_pieces(solid);
  EXPECT_EQ(broken_promise(solid, pieces, 1), "");
  EXPECT_NEAR(total_area(pieces), area, 1e-12 * (1 + area));
  EXPECT_LE(pieces.size(), at_most);
}

TEST(SignedArea, IsPositiveCounterClockwise) {
  EXPECT_EQ(signed_area(rectangle(1, 2, 4, 4)), 6.0);
  EXPECT_EQ(signed_area(reversed(rectangle(1, 2, 4, 4))), -6.0);
  EXPECT_EQ(signed_area({}), 0.0);
  EXPECT_EQ(signed_area({{1, 1}, {2, 2}}), 0.0);
}

TEST(Bounds, HoldEveryVertex) {
  const Box box = bounds({{1, 5}, {-2, 3}, {4, -1}});
  EXPECT_EQ(box.min, Vec2(-2, -1));
  EXPECT_EQ(box.max, Vec2(4, 5));
  EXPECT_TRUE(bounds({}).empty());
}

TEST(IsConvex, KnowsTheCases) {
  EXPECT_TRUE(is_convex(rectangle(0, 0, 1, 1)));
  EXPECT_TRUE(is_convex(regular(22, 0.2, 0.3)));
  EXPECT_TRUE(is_convex({{0, 0}, {1, 0}, {2, 0}, {2, 2}}));          // straight on
  EXPECT_TRUE(is_convex({{0, 0}, {1, 0}, {1, 0}, {1, 1}, {0, 0}}));  // a vertex twice
  EXPECT_TRUE(
      is_convex(turned({{0, 0}, {0.1, 0}, {0.3, 0}, {0.3, 1}}, 0.7)));  // straight on but for rounding
  EXPECT_FALSE(is_convex(reversed(rectangle(0, 0, 1, 1))));
  EXPECT_FALSE(is_convex({{0, 0}, {2, 0}, {1, 0.5}, {1, 2}}));
  EXPECT_FALSE(is_convex({{0, 0}, {2, 0}, {1, 0}, {1, 1}, {0, 1}}));  // a spike
  EXPECT_FALSE(is_convex({{2, 1}, {2, 5}, {2, 0}, {5, 2}, {0, 4}}));  // a spike along an edge
  EXPECT_FALSE(is_convex({{0, 0}, {1, 1}, {2, 2}}));
  EXPECT_FALSE(is_convex({{0, 0}, {1, 0}, {0, 0}, {1, 0}}));
  EXPECT_FALSE(is_convex({{0, 0}, {1, 0}}));
  EXPECT_FALSE(is_convex({}));
  Ring pentagram;
  const Ring pentagon = regular(5, 1, 0.1);
  for (const std::size_t i : {0u, 2u, 4u, 1u, 3u}) pentagram.push_back(pentagon[i]);
  EXPECT_FALSE(is_convex(pentagram));  // turns left everywhere, but winds twice
}

TEST(ConvexWidth, IsTheSmallestGapBetweenParallels) {
  EXPECT_DOUBLE_EQ(convex_width(rectangle(0, 0, 3, 0.5)), 0.5);
  EXPECT_NEAR(convex_width(turned(rectangle(0, 0, 3, 0.5), 1.1)), 0.5, 1e-15);
  EXPECT_DOUBLE_EQ(convex_width({{0, 0}, {4, 0}, {0, 3}}), 2.4);  // the height on the hypotenuse
  EXPECT_EQ(convex_width({{0, 0}, {4, 0}}), 0.0);
  EXPECT_EQ(convex_width({{0, 0}, {4, 0}, {4, 0}, {0, 0}}), 0.0);
}

TEST(ConvexPieces, AConvexContourComesBackWhole) {
  for (const Ring& ring :
       {rectangle(0, 0, 2, 1), regular(22, 0.2, 0.1), turned(rectangle(0, 0, 2, 1), 0.4)}) {
    for (const Ring& either : {ring, reversed(ring)}) {
      const std::vector<ConvexPrism> pieces = convex_pieces({{either}, k_height});
      ASSERT_EQ(pieces.size(), 1u);
      EXPECT_EQ(pieces[0].z, k_height);
      EXPECT_GT(signed_area(pieces[0].outline), 0);
      EXPECT_TRUE(
          std::is_permutation(ring.begin(), ring.end(), pieces[0].outline.begin(), pieces[0].outline.end()));
    }
  }
}

TEST(ConvexPieces, CoversLettersAndStars) {
  expect_exact_cover({{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}}, 3, 2);                  // L
  expect_exact_cover({{{0, 0}, {3, 0}, {3, 2}, {2, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}}, 5, 3);  // U
  expect_exact_cover({{{1, 0}, {2, 0}, {2, 2}, {3, 2}, {3, 3}, {0, 3}, {0, 2}, {1, 2}}}, 5, 2);  // T
  expect_exact_cover({turned({{1, 0}, {2, 0}, {2, 2}, {3, 2}, {3, 3}, {0, 3}, {0, 2}, {1, 2}}, 0.3)}, 5, 6);
  Ring star;
  for (int i = 0; i < 10; ++i)
    star.push_back(regular(10, i % 2 == 0 ? 2.0 : 0.8, 0.2)[static_cast<std::size_t>(i)]);
  expect_exact_cover({star}, signed_area(star), 9);
}

TEST(ConvexPieces, CoversRings) {
  expect_exact_cover({rectangle(0, 0, 4, 4), rectangle(1, 1, 3, 3)}, 12, 4);
  expect_exact_cover({rectangle(0, 0, 4, 4), reversed(rectangle(1, 1, 3, 3))}, 12, 4);
  const Ring outer = regular(22, 1, 0.05), inner = regular(22, 0.9, 0.05);
  expect_exact_cover({outer, inner}, signed_area(outer) - signed_area(inner), 44);
  // An island in the hole, and a second solid beside it.
  expect_exact_cover(
      {rectangle(0, 0, 9, 9), rectangle(1, 1, 8, 8), rectangle(3, 3, 5, 5), rectangle(11, 0, 12, 1)},
      81 - 49 + 4 + 1, 6);
}

TEST(ConvexPieces, CoversContoursThatCrossTouchOrCoincide) {
  expect_exact_cover({{{0, 0}, {2, 2}, {2, 0}, {0, 2}}}, 2, 2);              // a bow tie
  expect_exact_cover({rectangle(0, 0, 2, 2), rectangle(1, 1, 3, 3)}, 6, 4);  // overlapping corners
  expect_exact_cover({rectangle(0, 0, 1, 1), rectangle(1, 0, 2, 1)}, 2, 2);  // a common side
  expect_exact_cover({rectangle(0, 0, 1, 1), rectangle(1, 1, 2, 2)}, 2, 2);  // a common corner
  expect_exact_cover({rectangle(0, 0, 1, 1), rectangle(0, 0, 1, 1)}, 0, 0);  // twice the same
  expect_exact_cover({regular(5, 1, 0.3), turned(regular(5, 1, 0.3), 0)}, 0, 0);
  Ring pentagram;
  const Ring pentagon = regular(5, 1, 0.1);
  for (const std::size_t i : {0u, 2u, 4u, 1u, 3u}) pentagram.push_back(pentagon[i]);
  const Solid star = {{pentagram}, k_height};
  const std::vector<ConvexPrism> points = convex_pieces(star);  // even-odd: the middle is empty
  EXPECT_EQ(broken_promise(star, points, 2), "");
  EXPECT_FALSE(contains(star, {0, 0}));
}

TEST(ConvexPieces, DegenerateContoursHaveNoPieces) {
  const std::vector<std::vector<Ring>> degenerate = {{},
                                                     {{}},
                                                     {{{1, 1}}},
                                                     {{{1, 1}, {1, 1}, {1, 1}}},
                                                     {{{0, 0}, {1, 1}}},
                                                     {{{0, 0}, {1, 0}, {2, 0}}},
                                                     {{{0, 0}, {1, 1}, {3, 3}}},
                                                     {{{0, 0}, {0, 1}, {0, 2}, {0, 1}}},
                                                     {{{0, 0}, {0.1, 0.3}, {0.2, 0.6}, {0.1, 0.3}}}};
  for (std::size_t i = 0; i < degenerate.size(); ++i) {
    const std::vector<ConvexPrism> pieces = convex_pieces({degenerate[i], k_height});
    EXPECT_TRUE(pieces.empty()) << i;
  }
}

TEST(ConvexPieces, DuplicateAndStraightVerticesAreHarmless) {
  expect_exact_cover(
      {{{0, 0}, {1, 0}, {1, 0}, {2, 0}, {2, 1}, {1.5, 1}, {1, 1}, {1, 1.5}, {1, 2}, {0, 2}, {0, 1}, {0, 0}}},
      3, 2);
  // A spike without area, and a tiny step between two levels.
  expect_exact_cover({{{0, 0}, {2, 0}, {3, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}}, 3, 2);
  expect_exact_cover({{{0, 0}, {2, 1e-16}, {2, 1}, {1, 1 + 2e-16}, {1, 2}, {0, 2}}}, 3, 2);
}

// Cuts along one axis would leave slivers between corners that lie at almost the same height.
TEST(ConvexPieces, AvoidsSlivers) {
  for (const double step : {1e-8, 1e-6, 1e-4}) {
    const Ring fork{{-0.1, -0.15},   {0.1, -0.15}, {0.1, -0.1}, {0, -0.1},
                    {0, 0.1 + step}, {0.1, 0.1},   {0.1, 0.15}, {-0.1, 0.15}};
    const Ring tilted_l = turned({{0, 0}, {0.2, 0}, {0.2, 0.1}, {0.1, 0.1}, {0.1, 0.2}, {0, 0.2}}, 10 * step);
    for (const Ring& ring : {fork, tilted_l}) {
      const Solid solid = {{ring}, k_height};
      const std::vector<ConvexPrism> pieces = convex_pieces(solid);
      EXPECT_EQ(broken_promise(solid, pieces, 3), "") << step;
      EXPECT_NEAR(total_area(pieces), signed_area(ring), 1e-12) << step;
      for (const ConvexPrism& piece : pieces) EXPECT_GT(convex_width(piece.outline), 0.01) << step;
    }
  }
}

RC_GTEST_PROP(ConvexPieces, CoversRandomSimplePolygons, ()) {
  // Star-shaped about a point, so that the shoelace formula is the area.
  const auto seed = *rc::gen::arbitrary<std::uint32_t>();
  const auto corners = *rc::gen::inRange(3, 40);
  Random random(seed, 1, 1, 1);
  const Vec2 center(random.uniform(-100, 100), random.uniform(-100, 100));
  std::vector<double> bearings;
  for (int i = 0; i < corners; ++i) bearings.push_back(2 * k_pi * (i + random.uniform(0, 0.9)) / corners);
  Ring ring;
  for (const double bearing : bearings) {
    const SinCos s = sincos(bearing);
    ring.push_back(center + random.uniform(0.1, 2) * Vec2(s.cos, s.sin));
  }
  const Solid solid = {{ring}, k_height};
  const std::vector<ConvexPrism> pieces = convex_pieces(solid);
  RC_ASSERT(broken_promise(solid, pieces, seed) == "");
  RC_ASSERT(std::fabs(total_area(pieces) - std::fabs(signed_area(ring))) < 1e-9);
  RC_ASSERT(pieces.size() <= static_cast<std::size_t>(corners));
}

RC_GTEST_PROP(ConvexPieces, CoversRandomContoursOnAGrid, ()) {
  // Few positions, so that vertices coincide, edges overlap and contours cross and touch all the time.
  const auto seed = *rc::gen::arbitrary<std::uint32_t>();
  const auto contours = *rc::gen::inRange(1, 5);
  Random random(seed, 2, 2, 2);
  Solid solid = {{}, k_height};
  for (int c = 0; c < contours; ++c) {
    Ring ring;
    const std::uint32_t corners = 1 + random.below(10);
    for (std::uint32_t i = 0; i < corners; ++i) ring.emplace_back(random.below(6), random.below(6));
    solid.contours.push_back(ring);
  }
  RC_ASSERT(broken_promise(solid, convex_pieces(solid), seed) == "");
}

RC_GTEST_PROP(ConvexPieces, AreaOfRectangularRegionsIsThatOfTheirCells, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint32_t>();
  const auto rectangles = *rc::gen::inRange(1, 8);
  const auto angle = *rc::gen::element(0.0, 0.25, 1.0, k_pi / 2);
  Random random(seed, 3, 3, 3);
  Solid upright = {{}, k_height};
  for (int i = 0; i < rectangles; ++i) {
    const double x = random.below(8), y = random.below(8);
    upright.contours.push_back(rectangle(x, y, x + 1 + random.below(4), y + 1 + random.below(4)));
  }
  int cells = 0;
  for (int x = 0; x < 12; ++x) {
    for (int y = 0; y < 12; ++y) cells += winds_oddly(upright.contours, {x + 0.5, y + 0.5});
  }
  Solid solid = upright;
  for (Ring& ring : solid.contours) ring = turned(ring, angle);
  const std::vector<ConvexPrism> pieces = convex_pieces(solid);
  RC_ASSERT(std::fabs(total_area(pieces) - cells) < 1e-9);
  RC_ASSERT(broken_promise(solid, pieces, seed) == "");
}

TEST(ConvexPieces, TheOrderOfPiecesIsFixed) {
  const Solid solid = {{rectangle(0, 0, 9, 9), rectangle(1, 1, 8, 8), rectangle(3, 3, 5, 5)}, k_height};
  const std::vector<ConvexPrism> first = convex_pieces(solid);
  const std::vector<ConvexPrism> second = convex_pieces(solid);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].outline, second[i].outline);
}

}  // namespace
}  // namespace troupe::convex_test
