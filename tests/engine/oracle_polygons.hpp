#pragma once

#include "base/geometry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

/// Polygons with exact predicates, for oracles: nothing here is shared with what it checks. Vertices are
/// rounded to a lattice of 2^-44 m once; from there on everything is whole numbers, and every answer is that
/// of mathematics. Regions may be non-convex, of several contours (even-odd), and touch in any way.
namespace troupe::oracle {

__extension__ typedef __int128 Wide;

/// A lattice point, in units of 2^-45 m. Vertices have even coordinates, so that midpoints are points too.
/// Up to 65 km from the origin: a product of two differences then has 124 bits.
struct Point {
  std::int64_t x = 0;
  std::int64_t y = 0;
  friend bool operator==(Point, Point) = default;
};

inline Point lattice_point(double x_m, double y_m) {
  return {2 * std::llround(x_m * 0x1p44), 2 * std::llround(y_m * 0x1p44)};
}
inline Point middle(Point a, Point b) { return {(a.x + b.x) / 2, (a.y + b.y) / 2}; }
inline Point swapped(Point p) { return {p.y, p.x}; }

/// 1: p lies left of the way from a to b; -1: right; 0: on its line.
inline int side(Point a, Point b, Point p) {
  const Wide c = Wide(b.x - a.x) * (p.y - a.y) - Wide(b.y - a.y) * (p.x - a.x);
  return (c > 0) - (c < 0);
}

using Edge = std::array<Point, 2>;

inline bool on(const Edge& e, Point p) {
  return side(e[0], e[1], p) == 0 && std::min(e[0].x, e[1].x) <= p.x && p.x <= std::max(e[0].x, e[1].x) &&
         std::min(e[0].y, e[1].y) <= p.y && p.y <= std::max(e[0].y, e[1].y);
}
/// The edges cross at a point that is an end of neither.
inline bool cross_within(const Edge& e, const Edge& f) {
  return side(e[0], e[1], f[0]) * side(e[0], e[1], f[1]) < 0 &&
         side(f[0], f[1], e[0]) * side(f[0], f[1], e[1]) < 0;
}

/// The even-odd region of closed contours. No part of an edge may be drawn twice.
struct Region {
  std::vector<Edge> edges;
  Point low{INT64_MAX, INT64_MAX};
  Point high{INT64_MIN, INT64_MIN};

  void add(const std::vector<Point>& ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Edge edge{ring[i], ring[(i + 1) % ring.size()]};
      if (edge[0] != edge[1]) edges.push_back(edge);
      low = {std::min(low.x, ring[i].x), std::min(low.y, ring[i].y)};
      high = {std::max(high.x, ring[i].x), std::max(high.y, ring[i].y)};
    }
  }
};

/// Whether an odd number of edges lies strictly beyond the point along +x.
inline bool odd_beyond(const Region& region, Point p) {
  bool odd = false;
  for (const auto& [a, b] : region.edges)
    if ((a.y > p.y) != (b.y > p.y) && side(a, b, p) == (b.y > a.y ? 1 : -1)) odd = !odd;
  return odd;
}
inline bool odd_above(const Region& region, Point p) {
  bool odd = false;
  for (const auto& [a, b] : region.edges)
    if ((a.x > p.x) != (b.x > p.x) && side(swapped(a), swapped(b), swapped(p)) == (b.x > a.x ? 1 : -1))
      odd = !odd;
  return odd;
}
inline bool on_boundary(const Region& region, Point p) {
  return std::ranges::any_of(region.edges, [&](const Edge& e) { return on(e, p); });
}
/// Strictly inside.
inline bool contains(const Region& region, Point p) {
  return !on_boundary(region, p) && odd_beyond(region, p);
}

/// Where no edge of `a` crosses one of `b` within both: whether some stretch of a's boundary has ground of
/// both regions beside it. Cut at b's corners, each stretch lies wholly inside b, outside, or along b's
/// boundary; along it, they share ground if both have theirs on the same side.
inline bool boundary_shares_ground(const Region& a, const Region& b) {
  for (const Edge& e : a.edges) {
    std::vector<Point> cuts{e[0], e[1]};
    for (const Edge& f : b.edges)
      if (on(e, f[0])) cuts.push_back(f[0]);
    std::ranges::sort(cuts, {}, [](Point p) { return std::pair(p.x, p.y); });
    const bool flat = e[0].y == e[1].y;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
      if (cuts[i] == cuts[i + 1]) continue;
      const Point m = middle(cuts[i], cuts[i + 1]);
      if (contains(b, m)) return true;
      if (!on_boundary(b, m)) continue;
      if (flat ? odd_above(a, m) == odd_above(b, m) : odd_beyond(a, m) == odd_beyond(b, m)) return true;
    }
  }
  return false;
}

/// True when the regions have area in common. Where boundaries cross, they do. Where they do not, either some
/// stretch of one boundary lies inside the other region or along its boundary on the same side; or no
/// boundary enters the other region, and a region that lies inside the other has its whole boundary there.
inline bool share_area(const Region& a, const Region& b) {
  if (a.high.x <= b.low.x || b.high.x <= a.low.x || a.high.y <= b.low.y || b.high.y <= a.low.y) return false;
  for (const Edge& e : a.edges)
    for (const Edge& f : b.edges)
      if (cross_within(e, f)) return true;
  return boundary_shares_ground(a, b) || boundary_shares_ground(b, a);
}

/// Blocks at a pose, each over its heights. The rotation is libm's, not ours.
struct Block {
  Region region;
  double bottom;
  double top;
};
using Blocks = std::vector<Block>;

inline Blocks place(const std::vector<Solid>& solids, const Pose& pose) {
  const double c = std::cos(pose.heading);
  const double s = std::sin(pose.heading);
  Blocks blocks;
  for (const Solid& solid : solids) {
    Block block{{}, pose.z + solid.z.min, pose.z + solid.z.max};
    for (const Ring& contour : solid.contours) {
      std::vector<Point> ring;
      for (const Vec2& v : contour)
        ring.push_back(lattice_point(pose.x + c * v.x() - s * v.y(), pose.y + s * v.x() + c * v.y()));
      block.region.add(ring);
    }
    blocks.push_back(std::move(block));
  }
  return blocks;
}

/// Ground in common at a common height.
inline bool overlap(const Blocks& a, const Blocks& b) {
  for (const Block& p : a)
    for (const Block& q : b)
      if (std::max(p.bottom, q.bottom) < std::min(p.top, q.top) && share_area(p.region, q.region))
        return true;
  return false;
}

}  // namespace troupe::oracle
