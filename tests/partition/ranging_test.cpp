#include "partition/ranging.hpp"

#include "base/geometry.hpp"
#include "base/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <string>

namespace troupe::partition {
namespace {

constexpr double k_turn = 6.283185307179586;

#ifdef NDEBUG
constexpr std::uint32_t k_share = 1;
#else
constexpr std::uint32_t k_share = 40;  // of the trials in debug builds, which are that much slower
#endif

bool long_form() { return std::getenv("TROUPE_LONG") != nullptr; }

struct Beams {
  std::vector<float> dx, dy, ox, oy;

  std::size_t size() const { return dx.size(); }
  void add(double x, double y, float origin_x = 0, float origin_y = 0) {
    const double length = std::hypot(x, y);
    dx.push_back(static_cast<float>(x / length));
    dy.push_back(static_cast<float>(y / length));
    ox.push_back(origin_x);
    oy.push_back(origin_y);
  }
  Fan fan(bool common_origin) const { return {dx, dy, ox, oy, common_origin}; }
};

double log_uniform(Random& random, double low, double high) {
  return low * std::exp(random.uniform() * std::log(high / low));
}

// ---- the vector form is the formula

Vec2 direction(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// Edges of every kind that the formula treats differently.
RayEdge any_edge(Random& random) {
  const double size = log_uniform(random, 1e-6, 100);
  const double away = log_uniform(random, 1e-6, 100);
  const Vec2 reference(random.uniform(-1000, 1000), random.uniform(-1000, 1000));
  Vec2 a = away * direction(random.uniform(0, k_turn));
  Vec2 b;
  switch (random.below(8)) {
    case 0: b = a * random.uniform(-2, 2); break;  // its line meets the reference point
    case 1: b = a * random.uniform(-2, 2) + 1e-6 * direction(random.uniform(0, k_turn)); break;
    case 2: a.y() = 0, b = {random.uniform(-2, 2), 0}; break;
    case 3: a.x() = 0, b = {0, random.uniform(-2, 2)}; break;
    case 4: b = Vec2::Zero(); break;  // it ends in the reference point
    case 5: b = a; break;
    default: b = a + size * direction(random.uniform(0, k_turn)); break;
  }
  return relative_edge(reference + a, reference + b, reference, static_cast<float>(random.below(3)));
}

Beams any_beams(Random& random, bool common_origin, std::span<const RayEdge> edges) {
  Beams beams;
  const std::size_t count = 1 + random.below(70);
  for (std::size_t i = 0; i < count; ++i) {
    const float ox = common_origin ? 0.0f : static_cast<float>(random.uniform(-0.3, 0.3));
    const float oy = common_origin ? 0.0f : static_cast<float>(random.uniform(-0.3, 0.3));
    const RayEdge& aim = edges[random.below(static_cast<std::uint32_t>(edges.size()))];
    const double x = aim.ax - ox, y = aim.ay - oy;
    switch (x == 0 && y == 0 ? 0 : random.below(4)) {
      case 0: beams.add(std::cos(random.uniform(0, k_turn)), random.uniform(-1, 1), ox, oy); break;
      case 1: beams.add(random.below(2) ? 1 : -1, 0, ox, oy); break;
      case 2: beams.add(-x, -y, ox, oy); break;
      default: beams.add(x, y, ox, oy); break;
    }
  }
  return beams;
}

TEST(Ranging, TheVectorFormIsTheFormulaBitForBit) {
  for (std::uint32_t trial = 0; trial < 30000 / k_share; ++trial) {
    Random random(1, 1, 0, trial);
    const bool common_origin = random.below(2) == 0;
    std::vector<RayEdge> edges;
    for (std::uint32_t i = 0, n = 1 + random.below(20); i < n; ++i) edges.push_back(any_edge(random));
    const Beams beams = any_beams(random, common_origin, edges);

    std::vector<float> inverse(beams.size(), 0.0f);
    std::vector<float> with_returns(beams.size(), 0.0f);
    std::vector<float> returns(beams.size(), 0.0f);
    project(edges, beams.fan(common_origin), inverse);
    project(edges, beams.fan(common_origin), with_returns, returns);
    for (std::size_t i = 0; i < beams.size(); ++i) {
      float nearest = 0;
      float met = 0;
      for (const RayEdge& e : edges) {
        const float value = inverse_range(e, beams.dx[i], beams.dy[i], beams.ox[i], beams.oy[i]);
        ASSERT_GE(value, 0) << "trial " << trial;
        if (value > nearest || (value == nearest && value > 0 && e.ranger_return > met))
          met = e.ranger_return;
        nearest = std::max(nearest, value);
      }
      ASSERT_EQ(std::bit_cast<std::uint32_t>(inverse[i]), std::bit_cast<std::uint32_t>(nearest))
          << "trial " << trial;
      ASSERT_EQ(std::bit_cast<std::uint32_t>(with_returns[i]), std::bit_cast<std::uint32_t>(nearest));
      ASSERT_EQ(returns[i], met) << "trial " << trial;
    }
  }
}

TEST(Ranging, TheOrderOfEdgesChangesNothing) {
  for (std::uint32_t trial = 0; trial < 2000; ++trial) {
    Random random(1, 2, 0, trial);
    std::vector<RayEdge> edges;
    for (int i = 0; i < 20; ++i) edges.push_back(any_edge(random));
    const Beams beams = any_beams(random, false, edges);
    std::vector<float> inverse(beams.size(), 0.0f), returns(beams.size(), 0.0f);
    project(edges, beams.fan(false), inverse, returns);
    random.shuffle(edges);
    std::vector<float> shuffled(beams.size(), 0.0f), shuffled_returns(beams.size(), 0.0f);
    project(edges, beams.fan(false), shuffled, shuffled_returns);
    ASSERT_EQ(inverse, shuffled);
    ASSERT_EQ(returns, shuffled_returns);
  }
}

// ---- no leaks, and no reading out of place

/// Closed outlines of the kinds that trouble ray casters. About 1 m wide, around the origin.
Ring star(Random& random) {
  Ring ring;
  const std::uint32_t n = 3 + random.below(30);
  std::vector<double> angles;
  for (std::uint32_t i = 0; i < n; ++i) angles.push_back(random.uniform(0, k_turn));
  std::ranges::sort(angles);
  const double least = random.below(2) ? 0.01 : 0.5;
  for (const double angle : angles) ring.push_back(random.uniform(least, 1) * direction(angle));
  return ring;
}

Ring convex(Random& random) {
  Ring ring;
  const std::uint32_t n = 3 + random.below(60);
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = (i + random.uniform(0, 0.9)) * k_turn / n;
    ring.push_back(direction(angle));
  }
  return ring;
}

/// The border of a random pile of unit pixels: a staircase of axis-parallel edges, with collinear vertices.
Ring rectilinear(Random& random) {
  Ring ring;
  const std::uint32_t columns = 2 + random.below(12);
  const double pixel = 1.0 / columns;
  std::vector<double> tops, bottoms;
  for (std::uint32_t i = 0; i < columns; ++i) {
    tops.push_back(pixel * (1 + random.below(columns)));
    bottoms.push_back(-pixel * (1 + random.below(columns)));
  }
  for (std::uint32_t i = 0; i < columns; ++i) {
    ring.push_back({-0.5 + pixel * i, bottoms[i]});
    ring.push_back({-0.5 + pixel * (i + 1), bottoms[i]});
  }
  for (std::uint32_t i = columns; i-- > 0;) {
    ring.push_back({-0.5 + pixel * (i + 1), tops[i]});
    ring.push_back({-0.5 + pixel * i, tops[i]});
  }
  return ring;
}

/// A wheel of teeth whose flanks point at the middle: every other edge is seen end-on from there.
Ring radial(Random& random) {
  Ring ring;
  const std::uint32_t n = 3 + random.below(20);
  for (std::uint32_t i = 0; i < n; ++i) {
    const Vec2 from = direction(k_turn * i / n);
    const Vec2 to = direction(k_turn * (i + 0.5) / n);
    const double inner = random.uniform(0.2, 0.8);
    ring.insert(ring.end(), {inner * from, from, to, inner * to});
  }
  return ring;
}

/// Some edges are cut into many: collinear vertices, and edges of very different length.
Ring subdivided(const Ring& ring, Random& random) {
  Ring out;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    out.push_back(ring[i]);
    const Vec2 along = ring[(i + 1) % ring.size()] - ring[i];
    if (random.below(3) == 0) out.push_back(ring[i] + log_uniform(random, 1e-7, 0.9) * along);
    if (random.below(6) == 0)
      for (int k = 1; k < 6; ++k) out.push_back(ring[i] + (0.9 + 0.01 * k) * along);
  }
  return out;
}

Ring any_outline(Random& random) {
  Ring ring;
  switch (random.below(4)) {
    case 0: ring = star(random); break;
    case 1: ring = convex(random); break;
    case 2: ring = rectilinear(random); break;
    default: ring = radial(random); break;
  }
  if (random.below(2)) ring = subdivided(ring, random);
  if (random.below(2)) std::ranges::reverse(ring);
  return ring;
}

double segment_distance(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  const double length2 = along.squaredNorm();
  const double u = length2 > 0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (a + u * along - p).norm();
}

double distance(const Vec2& p, const Ring& ring) {
  double nearest = 1e300;
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++)
    nearest = std::min(nearest, segment_distance(p, ring[j], ring[i]));
  return nearest;
}

/// A point inside, often in an unlucky place: on the axes and diagonals of the outline's vertices, or very
/// near an edge. False where none is found that keeps `clearance` from every edge.
bool any_origin(Random& random, const Ring& ring, double clearance, Vec2& origin) {
  const auto pick = [&] { return ring[random.below(static_cast<std::uint32_t>(ring.size()))]; };
  const Solid solid{{ring}, {0, 1}};
  for (int attempt = 0; attempt < 20; ++attempt) {
    origin = {random.uniform(-1, 1), random.uniform(-1, 1)};
    switch (random.below(6)) {
      case 0: origin = Vec2::Zero(); break;
      case 1: origin = {pick().x(), pick().y()}; break;
      case 2: origin.x() = pick().x(); break;
      case 3: origin.y() = pick().y(); break;
      case 4: {
        const std::size_t i = random.below(static_cast<std::uint32_t>(ring.size()));
        const Vec2 a = ring[i], b = ring[(i + 1) % ring.size()];
        const Vec2 across(a.y() - b.y(), b.x() - a.x());
        if (across.norm() == 0) continue;
        const double off = log_uniform(random, 1e-12, 0.1) * (random.below(2) ? 1 : -1);
        origin = a + random.uniform() * (b - a) + off * across / across.norm();
        break;
      }
      default: break;
    }
    if (contains(solid, origin) && distance(origin, ring) > clearance) return true;
  }
  return false;
}

/// Where a beam may read, given that vertices within `width` of it may count for either side: the nearest
/// point of any edge within that strip, and the farthest point within it of the nearest edge that crosses it
/// whole.
struct Bracket {
  double low = 1e300;
  double high = 1e300;
};

void narrow(Bracket& bracket, double along_a, double side_a, double along_b, double side_b, double width) {
  if (std::min(side_a, side_b) > width || std::max(side_a, side_b) < -width) return;
  const auto along_at = [&](double side) {
    return along_a + (side - side_a) / (side_b - side_a) * (along_b - along_a);
  };
  const double first = std::abs(side_a) <= width ? along_a : along_at(side_a > 0 ? width : -width);
  const double last = std::abs(side_b) <= width ? along_b : along_at(side_b > 0 ? width : -width);
  const double farthest = std::max(first, last);
  if (farthest < -width) return;
  bracket.low = std::min(bracket.low, std::max(0.0, std::min(first, last)));
  const bool crosses = std::max(side_a, side_b) > width && std::min(side_a, side_b) < -width;
  if (crosses && std::min(first, last) > width) bracket.high = std::min(bracket.high, farthest);
}

struct Tally {
  std::uint64_t beams = 0;
  std::uint64_t leaks = 0;
  std::uint64_t short_readings = 0;
  std::uint64_t long_readings = 0;
  std::string first;  ///< few of what went wrong, a line each
};

/// Aims beams at the vertices of one outline.
void aim_at_vertices(std::uint32_t trial, bool common_origin, Tally& tally) {
  constexpr std::size_t k_beams = 200;
  Random random(7, common_origin ? 1 : 2, 0, trial);
  const Ring shape = any_outline(random);
  const double size = random.below(3) ? 5 : log_uniform(random, 1e-3, 3000);
  const Vec2 place =
      random.below(2) ? Vec2(0, 0) : Vec2(random.uniform(-1000, 1000), random.uniform(-1000, 1000));
  // With one origin, sides are exact down to the rounding of the world's own coordinates. Offsets are floats:
  // an origin nearer to a corner than their rounding may lie on its other side.
  const double rounding = place.norm() > 0 ? 1e-12 / size + 1e-15 : 1e-15;
  const double offset = 0.1;  // of the outline's size: how far origins lie from the reference
  Vec2 reference, first_origin;
  if (!any_origin(random, shape, common_origin ? rounding : 1e-6, first_origin)) return;
  reference = first_origin;

  Ring ring;
  for (const Vec2& v : shape) ring.push_back(place + size * v);
  reference = place + size * reference;
  std::vector<RayEdge> edges;
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++)
    if (ring[j] != ring[i]) edges.push_back(relative_edge(ring[j], ring[i], reference, 1));

  Beams beams;
  for (std::size_t k = 0; k < k_beams; ++k) {
    const Vec2 target = ring[random.below(static_cast<std::uint32_t>(ring.size()))];
    float ox = 0, oy = 0;
    if (!common_origin && random.below(4) != 0) {
      ox = static_cast<float>(size * random.uniform(-offset, offset));
      oy = static_cast<float>(size * random.uniform(-offset, offset));
      const Vec2 at = (reference + Vec2(ox, oy) - place) / size;
      if (!contains({{shape}, {0, 1}}, at) || distance(at, shape) < 1e-6) ox = oy = 0;
    }
    const Vec2 way = target - (reference + Vec2(ox, oy));
    if (way.norm() == 0) continue;
    beams.add(way.x(), way.y(), ox, oy);
    for (std::uint32_t nudge = random.below(3); nudge > 0; --nudge)
      beams.dx.back() = std::nextafter(beams.dx.back(), random.below(2) ? 2.0f : -2.0f);
  }
  std::vector<float> inverse(beams.size(), 0.0f);
  project(edges, beams.fan(common_origin), inverse);

  const auto range_max = static_cast<float>(10 * size);
  const double width = std::max(1e-5, 2e-6 * size);
  tally.beams += beams.size();
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const float range = range_of(inverse[i], range_max);
    const Vec2 d(beams.dx[i], beams.dy[i]);
    const Vec2 o = reference + Vec2(beams.ox[i], beams.oy[i]);
    Bracket bracket;
    for (std::size_t n = 0, m = ring.size() - 1; n < ring.size(); m = n++)
      narrow(bracket, (ring[m] - o).dot(d), cross(ring[m] - o, d), (ring[n] - o).dot(d),
             cross(ring[n] - o, d), width);
    const bool leaks = !(range < range_max);
    // Grazing edges: 1e-5 m over the sine of incidence, and never more than the slack.
    const bool too_short = range < bracket.low * (1 - k_range_slack / 2) - width;
    const bool too_long = !leaks && range > bracket.high * (1 + k_range_slack / 2) + width;
    tally.leaks += leaks;
    tally.short_readings += too_short;
    tally.long_readings += too_long;
    if ((leaks || too_short || too_long) && std::ranges::count(tally.first, '\n') < 5) {
      std::ostringstream text;
      text << "trial " << trial << " beam " << i << (common_origin ? " common" : " apart") << ": " << range
           << " m, [" << bracket.low << ", " << bracket.high << "], size " << size << " at "
           << place.transpose() << ", clearance " << size * distance(first_origin, shape) << " m\n";
      tally.first += text.str();
    }
  }
}

void expect_tight(bool common_origin) {
  const std::uint64_t wanted = long_form() ? 100'000'000 : 2'000'000 / k_share;
  Tally tally;
  for (std::uint32_t trial = 0; tally.beams < wanted; ++trial) aim_at_vertices(trial, common_origin, tally);
  EXPECT_EQ(tally.leaks, 0u) << "of " << tally.beams << "; first:\n" << tally.first;
  EXPECT_EQ(tally.short_readings, 0u) << "of " << tally.beams << "; first:\n" << tally.first;
  EXPECT_EQ(tally.long_readings, 0u) << "of " << tally.beams << "; first:\n" << tally.first;
  testing::Test::RecordProperty("beams", std::to_string(tally.beams));
  std::printf("%llu beams aimed at vertices, %llu left the outline\n",
              static_cast<unsigned long long>(tally.beams), static_cast<unsigned long long>(tally.leaks));
}

// TROUPE_LONG=1 in the environment: a hundred million beams each.
TEST(Ranging, NoBeamAimedAtAVertexLeavesAClosedOutlineFromOneOrigin) { expect_tight(true); }
TEST(Ranging, NoBeamAimedAtAVertexLeavesAClosedOutlineFromManyOrigins) { expect_tight(false); }

// ---- precision of single edges

TEST(Ranging, ShortEdgesFarAwayAreMetToTheTolerance) {
  double worst = 0;  // of the error times the sine of incidence
  for (std::uint32_t trial = 0; trial < 2'000'000 / k_share; ++trial) {
    Random random(3, 1, 0, trial);
    const Vec2 reference(random.uniform(-1000, 1000), random.uniform(-1000, 1000));
    const double length = log_uniform(random, 1e-3, 100);
    const double bearing = random.uniform(0, k_turn);
    const Vec2 along = direction(random.uniform(0, k_turn));
    const double u = random.uniform(0.05, 0.95);
    const Vec2 a = reference + log_uniform(random, 1e-3, 20) * direction(bearing) - u * length * along;
    const Vec2 b = a + length * along;
    const bool common_origin = random.below(2) == 0;
    const auto ox = static_cast<float>(common_origin ? 0 : random.uniform(-0.3, 0.3));
    const auto oy = static_cast<float>(common_origin ? 0 : random.uniform(-0.3, 0.3));
    const Vec2 o = reference + Vec2(ox, oy);
    const Vec2 aim = a + random.uniform(0.05, 0.95) * (b - a) - o;
    Beams beams;
    beams.add(aim.x(), aim.y(), ox, oy);
    const Vec2 d = Vec2(beams.dx[0], beams.dy[0]).normalized();
    if (std::abs(cross(a - o, d)) < 1e-5 || std::abs(cross(b - o, d)) < 1e-5) continue;
    const double sine = std::abs(cross(b - a, d)) / (b - a).norm();
    const double truth = cross(a - o, b - a) / cross(d, b - a);
    if (truth < 1e-5 / sine) continue;  // so near that it may as well lie behind
    const float inverse = inverse_range(relative_edge(a, b, reference, 1), beams.dx[0], beams.dy[0], ox, oy);
    ASSERT_GT(inverse, 0) << "trial " << trial;
    worst = std::max(worst, std::abs(1.0 / inverse - truth) * sine);
  }
  EXPECT_LT(worst, 1e-5);
  std::printf("largest error times sine of incidence up to 20 m: %.2g m\n", worst);
}

// ---- edge cases

float range_to(Vec2 a, Vec2 b, Vec2 way, Vec2 origin = {0, 0}) {
  Beams beams;
  beams.add(way.x(), way.y());
  return range_of(inverse_range(relative_edge(a, b, origin, 1), beams.dx[0], beams.dy[0], 0, 0), 10);
}

TEST(Ranging, EdgesAreMetFromBothSidesAndNotBehind) {
  EXPECT_EQ(range_to({2, -1}, {2, 1}, {1, 0}), 2);
  EXPECT_EQ(range_to({2, 1}, {2, -1}, {1, 0}), 2);
  EXPECT_EQ(range_to({-2, -1}, {-2, 1}, {1, 0}), 10);
  EXPECT_EQ(range_to({-2, 1}, {-2, -1}, {1, 0}), 10);
  EXPECT_EQ(range_to({2, 0.5}, {2, 1}, {1, 0}), 10) << "passes beside";
}

TEST(Ranging, AnEdgeSeenEndOnIsMetAtItsNearerEnd) {
  EXPECT_EQ(range_to({2, 0}, {3, 0}, {1, 0}), 2);
  EXPECT_EQ(range_to({3, 0}, {2, 0}, {1, 0}), 2);
  EXPECT_EQ(range_to({-2, 0}, {-3, 0}, {1, 0}), 10);
  EXPECT_NEAR(range_to({2, 2}, {3, 3}, {1, 1}), std::sqrt(8.0), 1e-6);
}

TEST(Ranging, ABeamThatStartsOnAnEdgeReadsZero) {
  for (const Vec2& way : {Vec2(1, 0), Vec2(-1, 0), Vec2(0, 1), Vec2(1, 3)}) {
    EXPECT_EQ(range_to({0, -1}, {0, 1}, way), 0);
    EXPECT_EQ(range_to({0.1, 0.3}, {0.5, 1.5}, way, {0.2, 0.6}), 0) << "on the line but for rounding";
  }
}

TEST(Ranging, AVertexIsMetByEachOfItsEdges) {
  EXPECT_EQ(range_to({2, 0}, {2, 1}, {1, 0}), 2);
  EXPECT_EQ(range_to({2, -1}, {2, 0}, {1, 0}), 2);
}

TEST(Ranging, RangeMaxItselfUnlessSomethingIsNearer) {
  EXPECT_EQ(range_of(0, 5), 5);
  EXPECT_EQ(range_of(1.0f / 5, 5), 5);
  EXPECT_EQ(range_of(1.0f / 6, 5), 5);
  EXPECT_LT(range_of(1.0f / 4.99f, 5), 5);
  EXPECT_EQ(range_of(std::numeric_limits<float>::infinity(), 5), 0);
  for (float max = 0.1f; max < 20; max *= 1.0001f) {
    EXPECT_EQ(range_of(0, max), max);
    EXPECT_LE(range_of(std::nextafter(1.0f / max, 100.0f), max), max);
  }
}

}  // namespace
}  // namespace troupe::partition
