#pragma once

#include "base/geometry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

/// Polygons with exact predicates, for oracles: slow reference implementations with which tests compare the
/// engine. This code shares nothing with the engine. Vertices are first rounded to a lattice with a step of
/// 2^-44 m. All later computations use integers, and so have no rounding errors. Regions may be non-convex
/// and have several contours (even-odd rule), and two regions may touch in any way.
namespace troupe::oracle {

__extension__ typedef __int128 Wide;

/// A point with integer coordinates in units of 2^-45 m. Vertices of polygons have even coordinates, so that
/// the midpoint of two vertices also has integer coordinates. Points must be at most 65 km from the origin. A
/// product of two coordinate differences is then at most 2^124 and fits into `Wide`.
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

/// Returns 1 if p is to the left of the directed line from a to b, -1 if it is to the right, and 0 if it is
/// on the line.
inline int side(Point a, Point b, Point p) {
  const Wide c = Wide(b.x - a.x) * (p.y - a.y) - Wide(b.y - a.y) * (p.x - a.x);
  return (c > 0) - (c < 0);
}

using Edge = std::array<Point, 2>;

inline bool on(const Edge& e, Point p) {
  return side(e[0], e[1], p) == 0 && std::min(e[0].x, e[1].x) <= p.x && p.x <= std::max(e[0].x, e[1].x) &&
         std::min(e[0].y, e[1].y) <= p.y && p.y <= std::max(e[0].y, e[1].y);
}
/// Whether two edges cross at a point that is an end of neither edge.
inline bool cross_within(const Edge& e, const Edge& f) {
  return side(e[0], e[1], f[0]) * side(e[0], e[1], f[1]) < 0 &&
         side(f[0], f[1], e[0]) * side(f[0], f[1], e[1]) < 0;
}

/// The region inside closed contours, by the even-odd rule: a point is inside if a ray from the point crosses
/// an odd number of edges. No two edges may overlap along a section.
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

/// Whether a ray from p in the direction +x crosses an odd number of edges of the region. Edges through p
/// itself are not counted.
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
/// Whether p is inside the region and not on its boundary.
inline bool contains(const Region& region, Point p) {
  return !on_boundary(region, p) && odd_beyond(region, p);
}

/// Whether some section of a's boundary has, on one of its sides, points of both regions. No edge of `a` may
/// cross an edge of `b` at a point that is an end of neither edge.
///
/// Method: the corners of `b` that are on a's boundary divide it into sections. Each section is inside b,
/// outside b, or on b's boundary. A section inside b always has such points. A section on b's boundary has
/// them if both regions are on the same side of it.
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

/// Whether the intersection of two regions has an area above 0; regions that only touch have none.
///
/// Method: if edges of the two boundaries cross, the regions share area. Otherwise they share area exactly if
/// boundary_shares_ground() is true for one of the two boundaries.
inline bool share_area(const Region& a, const Region& b) {
  if (a.high.x <= b.low.x || b.high.x <= a.low.x || a.high.y <= b.low.y || b.high.y <= a.low.y) return false;
  for (const Edge& e : a.edges)
    for (const Edge& f : b.edges)
      if (cross_within(e, f)) return true;
  return boundary_shares_ground(a, b) || boundary_shares_ground(b, a);
}

/// A block of a body at a given pose: a region, extruded over the heights from `bottom` to `top` (m, world
/// frame).
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

/// Whether two bodies overlap: a block of `a` and a block of `b` have area in common over an interval of
/// heights. Bodies that only touch do not overlap.
inline bool overlap(const Blocks& a, const Blocks& b) {
  for (const Block& p : a)
    for (const Block& q : b)
      if (std::max(p.bottom, q.bottom) < std::min(p.top, q.top) && share_area(p.region, q.region))
        return true;
  return false;
}

}  // namespace troupe::oracle
