#include "partition/ranging.hpp"

#include "base/geometry.hpp"
#include "base/random.hpp"
#include "tests/support/simd_targets.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace troupe::partition::ranging_test {
namespace {

constexpr double k_turn = 6.283185307179586;

#ifdef NDEBUG
constexpr std::uint32_t k_share = 1;
#else
constexpr std::uint32_t k_share = 40;  // debug builds, which are slower, run one trial in k_share
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
  Beams part(std::size_t first, std::size_t most) const {
    Beams out;
    for (std::size_t i = first; i < std::min(first + most, size()); ++i) {
      out.dx.push_back(dx[i]);
      out.dy.push_back(dy[i]);
      out.ox.push_back(ox[i]);
      out.oy.push_back(oy[i]);
    }
    return out;
  }
};

struct Edge {
  Vec2 a, b;  // world frame
  float ranger_return;
};

struct Readings {
  std::vector<float> inverse, returns;
};

/// Computes the readings with the kernels, in blocks of edges, as the sensor does.
Readings cast(std::span<const Edge> edges, const Vec2& reference, const Beams& beams, bool common_origin,
              bool with_returns, const Scan* scan = nullptr) {
  // A fan takes few beams, a scan any number.
  if (scan == nullptr && beams.size() > k_most_beams) {
    Readings out;
    for (std::size_t first = 0; first < beams.size(); first += k_most_beams) {
      const Readings part =
          cast(edges, reference, beams.part(first, k_most_beams), common_origin, with_returns);
      out.inverse.insert(out.inverse.end(), part.inverse.begin(), part.inverse.end());
      out.returns.insert(out.returns.end(), part.returns.begin(), part.returns.end());
    }
    return out;
  }
  const std::size_t padded = padded_beams(beams.size());
  Beams b = beams;
  for (std::vector<float>* array : {&b.dx, &b.dy, &b.ox, &b.oy}) array->resize(padded, array->back());
  const Fan fan{b.dx.data(), b.dy.data(), b.ox.data(), b.oy.data(), beams.size(), common_origin, false, scan};
  Readings out{std::vector<float>(padded, 0.0f), std::vector<float>(padded, 0.0f)};
  EdgeBlock block;
  const auto flush = [&] {
    float* returns = with_returns ? out.returns.data() : nullptr;
    project(block, reference, fan, out.inverse.data(), returns);
    block.clear();
  };
  for (const Edge& e : edges) {
    if (block.room() == 0) flush();
    const std::array<Vec2, EdgeBlock::k_piece> rest{e.b};
    block.add(e.a, rest.data(), 1, e.ranger_return, all_beams(fan));
  }
  flush();
  out.inverse.resize(beams.size());
  out.returns.resize(beams.size());
  return out;
}

/// Computes the readings with inverse_range(), for each edge and each beam.
Readings formula(std::span<const Edge> edges, const Vec2& reference, const Beams& beams) {
  Readings out{std::vector<float>(beams.size(), 0.0f), std::vector<float>(beams.size(), 0.0f)};
  for (const Edge& edge : edges) {
    const RayEdge e = relative_edge(edge.a, edge.b, reference, edge.ranger_return);
    for (std::size_t i = 0; i < beams.size(); ++i) {
      const float value = inverse_range(e, beams.dx[i], beams.dy[i], beams.ox[i], beams.oy[i]);
      EXPECT_GE(value, 0);
      if (value > out.inverse[i] ||
          (value == out.inverse[i] && value > 0 && e.ranger_return > out.returns[i]))
        out.returns[i] = e.ranger_return;
      out.inverse[i] = std::max(out.inverse[i], value);
    }
  }
  return out;
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return std::ranges::equal(a, b, {}, std::bit_cast<std::uint32_t, float>,
                            std::bit_cast<std::uint32_t, float>);
}

double log_uniform(Random& random, double low, double high) {
  return low * std::exp(random.uniform() * std::log(high / low));
}

// ---- the kernels give the bits of inverse_range()

Vec2 direction(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// Edges of every kind that the formula treats differently.
Edge any_edge(Random& random, const Vec2& reference) {
  const double size = log_uniform(random, 1e-6, 100);
  const double away = log_uniform(random, 1e-6, 100);
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
  return {reference + a, reference + b, static_cast<float>(random.below(3))};
}

Vec2 any_place(Random& random) { return {random.uniform(-1000, 1000), random.uniform(-1000, 1000)}; }

Beams any_beams(Random& random, bool common_origin, std::span<const Edge> edges, const Vec2& reference) {
  Beams beams;
  const std::size_t count = 1 + random.below(70);
  for (std::size_t i = 0; i < count; ++i) {
    const float ox = common_origin ? 0.0f : static_cast<float>(random.uniform(-0.3, 0.3));
    const float oy = common_origin ? 0.0f : static_cast<float>(random.uniform(-0.3, 0.3));
    const Edge& edge = edges[random.below(static_cast<std::uint32_t>(edges.size()))];
    const RayEdge aim = relative_edge(edge.a, edge.b, reference, 1);
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

/// Expects the kernels of every instruction set to give the bits of inverse_range().
void expect_formula(std::span<const Edge> edges, const Vec2& reference, const Beams& beams,
                    bool common_origin, const Scan* scan, std::uint32_t trial) {
  const Readings expected = formula(edges, reference, beams);
  for_each_simd_target([&](const std::string& target) {
    const Readings without = cast(edges, reference, beams, common_origin, false, scan);
    const Readings with = cast(edges, reference, beams, common_origin, true, scan);
    ASSERT_TRUE(same_bits(without.inverse, expected.inverse)) << target << ", trial " << trial;
    ASSERT_TRUE(same_bits(with.inverse, expected.inverse)) << target << ", trial " << trial;
    ASSERT_EQ(with.returns, expected.returns) << target << ", trial " << trial;
  });
}

TEST(Ranging, TheVectorFormIsTheFormulaBitForBitOnEveryInstructionSet) {
  for (std::uint32_t trial = 0; trial < 10000 / k_share; ++trial) {
    Random random(1, 1, 0, trial);
    const bool common_origin = random.below(2) == 0;
    const Vec2 reference = any_place(random);
    std::vector<Edge> edges;
    for (std::uint32_t i = 0, n = 1 + random.below(random.below(10) ? 20 : 300); i < n; ++i)
      edges.push_back(any_edge(random, reference));
    const Beams beams = any_beams(random, common_origin, edges, reference);
    ASSERT_NO_FATAL_FAILURE(expect_formula(edges, reference, beams, common_origin, nullptr, trial));
  }
}

TEST(Ranging, AScanBySpansIsTheFormulaBitForBitOnEveryInstructionSet) {
  for (std::uint32_t trial = 0; trial < 5000 / k_share; ++trial) {
    Random random(1, 3, 0, trial);
    const Vec2 reference = any_place(random);
    const std::size_t samples = 33 + random.below(random.below(8) ? 300 : 3000);
    const double fov = random.below(3) ? random.uniform(0.01, k_turn) : random.below(2) ? k_turn : k_turn / 2;
    const double middle = random.uniform(-k_turn, k_turn);
    const double step = fov / static_cast<double>(samples - 1);
    Beams beams;
    for (std::size_t i = 0; i < samples; ++i) {
      const Vec2 d = direction(middle - fov / 2 + static_cast<double>(i) * step);
      beams.add(d.x(), d.y());
    }
    const Scan scan{direction(middle), static_cast<float>(fov), static_cast<float>(step)};
    std::vector<Edge> edges;
    for (std::uint32_t i = 0, n = 1 + random.below(150); i < n; ++i) {
      edges.push_back(any_edge(random, reference));
      // Ends on beams, and at the back, where angles jump.
      if (random.below(3) == 0) {
        const double beam =
            middle - fov / 2 + static_cast<double>(random.below(static_cast<std::uint32_t>(samples))) * step;
        edges.back().a =
            reference + random.uniform(0.01, 10) * direction(random.below(4) ? beam : middle + k_turn / 2);
      }
    }
    ASSERT_NO_FATAL_FAILURE(expect_formula(edges, reference, beams, true, &scan, trial));
  }
}

TEST(Ranging, TheOrderOfEdgesChangesNothing) {
  for (std::uint32_t trial = 0; trial < 2000; ++trial) {
    Random random(1, 2, 0, trial);
    const Vec2 reference = any_place(random);
    std::vector<Edge> edges;
    for (int i = 0; i < 20; ++i) edges.push_back(any_edge(random, reference));
    const Beams beams = any_beams(random, false, edges, reference);
    const Readings first = cast(edges, reference, beams, false, true);
    random.shuffle(edges);
    const Readings shuffled = cast(edges, reference, beams, false, true);
    ASSERT_EQ(first.inverse, shuffled.inverse);
    ASSERT_EQ(first.returns, shuffled.returns);
  }
}

/// A fan of a random kind around a reference point: a ring, beams with origins of their own, or a scan.
class AnyFan {
 public:
  explicit AnyFan(Random& random) : kind_(static_cast<Kind>(random.below(k_kinds))) {
    count_ = kind_ == k_scan ? 33 + random.below(200) : 2 * (1 + random.below(16));
    const double fov = kind_ == k_scan ? random.uniform(0.1, k_turn) : k_turn;
    const double middle = random.uniform(-3, 3);
    const double step = fov / static_cast<double>(kind_ == k_scan ? count_ - 1 : count_);
    for (std::size_t i = 0; i < count_; ++i) {
      const double way = kind_ == k_scan ? middle - fov / 2 + static_cast<double>(i) * step
                                         : middle + static_cast<double>(i) * step;
      beams_.add(std::cos(way), std::sin(way),
                 kind_ == k_apart ? static_cast<float>(random.uniform(-0.3, 0.3)) : 0.0f,
                 kind_ == k_apart ? static_cast<float>(random.uniform(-0.3, 0.3)) : 0.0f);
    }
    for (std::vector<float>* array : {&beams_.dx, &beams_.dy, &beams_.ox, &beams_.oy})
      array->resize(padded_beams(count_), array->back());
    scan_ = {direction(middle), static_cast<float>(fov), static_cast<float>(step)};
    mirrored_ = kind_ == k_ring || (kind_ == k_apart && random.below(2) == 0);
  }

  Fan fan() const {
    return {beams_.dx.data(), beams_.dy.data(), beams_.ox.data(), beams_.oy.data(),
            count_,           kind_ != k_apart, mirrored_,        kind_ == k_scan ? &scan_ : nullptr};
  }
  int kind() const { return kind_; }
  /// An upper bound on the distances of origins from the reference.
  static constexpr float k_apart_by = 0.5f;

 private:
  enum Kind { k_ring, k_apart, k_scan, k_kinds };
  Kind kind_;
  std::size_t count_ = 0;
  Beams beams_;
  Scan scan_;
  bool mirrored_ = false;
};

/// Circles about edges, so that an edge that would raise a reading must survive the cull of its circle.
TEST(Ranging, CullsKeepEveryCircleThatCounts) {
  for_each_simd_target([](const std::string& target) {
    std::size_t kept = 0, all = 0;
    for (std::uint32_t trial = 0; trial < 4000 / k_share; ++trial) {
      Random random(1, 4, 0, trial);
      const Vec2 reference = any_place(random);
      const AnyFan any(random);
      const Fan fan = any.fan();

      const std::size_t circles_count = k_circle_padding * (1 + random.below(4));
      std::vector<Edge> edges;
      CircleArrays circles;
      circles.change_capacity(circles_count);
      for (std::uint32_t c = 0; c < circles_count; ++c) {
        const Vec2 center = reference + log_uniform(random, 0.01, 10) * direction(random.uniform(0, k_turn));
        const double radius = log_uniform(random, 0.001, 3);
        edges.push_back({center + random.uniform(0.9, 1) * radius * direction(random.uniform(0, k_turn)),
                         center + random.uniform(0.9, 1) * radius * direction(random.uniform(0, k_turn)), 1});
        circles.set(c, enclosing_circle(center, radius, c));
      }
      // Readings of earlier edges, which shorten the beams.
      std::vector<float> inverse(fan.padded()), limits(fan.padded()), range_max(fan.padded(), 8.0f);
      for (float& value : inverse)
        value = random.below(3) ? static_cast<float>(1 / random.uniform(0.1, 10)) : 0;
      const float farthest = limits_of(fan, inverse.data(), range_max.data(), limits.data());
      const float near = static_cast<float>(random.uniform(0, 5));
      std::vector<std::optional<BeamSet>> survives(circles_count);
      MetCircles met;
      const float from_reference = farthest + AnyFan::k_apart_by;
      for (const auto& [low, high] :
           {std::pair(-std::numeric_limits<float>::infinity(), near), std::pair(near, from_reference)}) {
        const std::size_t n =
            may_meet(circles, 0, circles_count, reference, fan, limits.data(), low, high, met);
        for (std::size_t i = 0; i < n; ++i) survives[met.row[i]] = met.beams[i];
      }
      for (std::size_t c = 0; c < circles_count; ++c) {
        const RayEdge e = relative_edge(edges[c].a, edges[c].b, reference, 1);
        ++all;
        kept += survives[c].has_value();
        for (std::size_t i = 0; i < fan.count; ++i) {
          const float value = inverse_range(e, fan.dx[i], fan.dy[i], fan.ox[i], fan.oy[i]);
          const bool counts = value > inverse[i] && range_of(value, range_max[i]) < range_max[i];
          ASSERT_TRUE(!counts || (survives[c] && (fan.scan != nullptr || (*survives[c] >> i & 1) != 0)))
              << target << ", trial " << trial << ", kind " << any.kind();
        }
      }
    }
    EXPECT_LT(kept, all * 7 / 10) << target << ": hardly anything is culled";
  });
}

// Of all beams only one is long. Every circle that it reaches must survive the cull, wherever it is along the
// beam, and also if no part of the circle is nearer than the bound of the search.
TEST(Ranging, CullsKeepTheCirclesOfASingleLongBeam) {
  for_each_simd_target([](const std::string& target) {
    for (std::uint32_t trial = 0; trial < 4000 / k_share; ++trial) {
      Random random(1, 5, 0, trial);
      const Vec2 reference = any_place(random);
      const AnyFan any(random);
      const Fan fan = any.fan();
      std::vector<float> inverse(fan.padded(), 50.0f), limits(fan.padded()), range_max(fan.padded(), 8.0f);
      const std::size_t beam = random.below(static_cast<std::uint32_t>(fan.count));
      const double range = random.uniform(0.3, 8);
      inverse[beam] = static_cast<float>(1 / range);
      if (fan.scan != nullptr) std::fill(inverse.begin() + fan.count, inverse.end(), inverse[fan.count - 1]);
      const float farthest = limits_of(fan, inverse.data(), range_max.data(), limits.data());

      const double radius = log_uniform(random, 0.001, 1);
      const Vec2 origin(fan.ox[beam], fan.oy[beam]);
      const Vec2 heading(fan.dx[beam], fan.dy[beam]);
      const Vec2 touched = origin + random.uniform(0, 1) * range * heading;
      const double turned = random.below(2) == 0 ? 0 : random.uniform(0, k_turn);
      const Vec2 center = touched + 0.99 * radius * direction(std::atan2(heading.y(), heading.x()) + turned);
      const double nearest = center.norm() - radius;
      CircleArrays circles;
      circles.change_capacity(k_circle_padding);
      circles.set(0, enclosing_circle(reference + center, radius, 7));
      for (std::size_t c = 1; c < k_circle_padding; ++c)
        circles.set(c, {0, 0, -std::numeric_limits<float>::infinity(), 0});
      const auto low = static_cast<float>(nearest > 0 ? nearest : -std::numeric_limits<double>::infinity());
      MetCircles met;
      const std::size_t n = may_meet(circles, 0, k_circle_padding, reference, fan, limits.data(), low,
                                     farthest + AnyFan::k_apart_by, met);
      ASSERT_EQ(n, 1u) << target << ", trial " << trial << ", kind " << any.kind();
      ASSERT_EQ(met.row[0], 7u);
      ASSERT_TRUE(fan.scan != nullptr || (met.beams[0] >> beam & 1) != 0) << target << ", trial " << trial;
    }
  });
}

// A circle that is beyond the readings of the beams that span it is discarded, although other beams reach
// farther.
TEST(Ranging, ACircleOfAScanIsCulledByTheReadingsOfItsOwnBeams) {
  for_each_simd_target([](const std::string& target) {
    constexpr std::size_t k_beams = 180, k_middle = 90;
    const double step = k_turn / 2 / (k_beams - 1);
    Beams beams;
    for (std::size_t i = 0; i < padded_beams(k_beams); ++i) {
      const Vec2 d = direction((static_cast<double>(std::min(i, k_beams - 1)) - k_middle) * step);
      beams.add(d.x(), d.y());
    }
    const Scan scan{direction(-0.5 * step), static_cast<float>(k_turn / 2), static_cast<float>(step)};
    const Fan fan{
        beams.dx.data(), beams.dy.data(), beams.ox.data(), beams.oy.data(), k_beams, true, false, &scan};
    CircleArrays circles;
    circles.change_capacity(k_circle_padding);
    circles.set(0, enclosing_circle({4, 0}, 4 * std::sin(1.5 * step), 7));  // that one beam more may meet
    for (std::size_t c = 1; c < k_circle_padding; ++c)
      circles.set(c, {0, 0, -std::numeric_limits<float>::infinity(), 0});
    std::vector<float> inverse(padded_beams(k_beams)), limits(inverse.size()),
        range_max(inverse.size(), 8.0f);
    const auto met_behind = [&](std::size_t near_beams) {
      std::ranges::fill(inverse, 0.0f);
      for (std::size_t i = 0; i < near_beams; ++i) inverse[k_middle - near_beams / 2 + i] = 1;
      const float farthest = limits_of(fan, inverse.data(), range_max.data(), limits.data());
      MetCircles met;
      return may_meet(circles, 0, k_circle_padding, Vec2::Zero(), fan, limits.data(), 0, farthest, met);
    };
    EXPECT_EQ(met_behind(5), 0u) << target;
    EXPECT_EQ(met_behind(1), 1u) << target;
    EXPECT_EQ(met_behind(0), 1u) << target;
  });
}

// ---- no beam leaves a closed outline, and every reading is near the outline

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

/// Finds a random point inside the outline, often in a place where rounding matters: with a coordinate of a
/// vertex, or very near an edge. Returns false if no point was found whose distance from every edge is at
/// least `clearance`.
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

/// Bounds on the reading of a beam if each vertex within `width` of the beam may count as on either side of
/// it. The strip is the set of points within `width` of the beam. `low` is the nearest point of any edge in
/// the strip, and `high` is the farthest point in the strip of the nearest edge that crosses the whole strip.
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
  std::string first;  ///< the first errors, one per line
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
  std::vector<Edge> edges;
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++)
    if (ring[j] != ring[i]) edges.push_back({ring[j], ring[i], 1});

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
  if (beams.size() == 0) return;
  const std::vector<float> inverse = cast(edges, reference, beams, common_origin, false).inverse;

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
}  // namespace troupe::partition::ranging_test
