#pragma once

#include "base/pose.hpp"

#include <algorithm>
#include <limits>
#include <vector>

namespace troupe {

/// z component of the cross product a x b: positive when b lies counter-clockwise of a.
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// A closed interval of heights, metres.
struct ZInterval {
  double min = 0;
  double max = 0;

  bool contains(double z) const { return min <= z && z <= max; }
  /// Bodies that only touch do not overlap.
  bool overlaps(const ZInterval& other) const { return min < other.max && other.min < max; }
  ZInterval shifted(double dz) const { return {min + dz, max + dz}; }
  friend bool operator==(const ZInterval&, const ZInterval&) = default;
};

/// Axis-aligned box. Empty (min > max) until extended.
struct Box {
  Vec2 min = Vec2::Constant(std::numeric_limits<double>::infinity());
  Vec2 max = Vec2::Constant(-std::numeric_limits<double>::infinity());

  bool empty() const { return min.x() > max.x() || min.y() > max.y(); }
  Vec2 size() const { return max - min; }
  Vec2 center() const { return 0.5 * (min + max); }
  void extend(const Vec2& p) {
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
  void extend(const Box& b) {
    min = min.cwiseMin(b.min);
    max = max.cwiseMax(b.max);
  }
  Box expanded(double margin) const {
    Box b;
    b.min = min.array() - margin;
    b.max = max.array() + margin;
    return b;
  }
  bool contains(const Vec2& p) const {
    return min.x() <= p.x() && p.x() <= max.x() && min.y() <= p.y() && p.y() <= max.y();
  }
  /// True when the closed boxes meet.
  bool touches(const Box& b) const {
    return min.x() <= b.max.x() && b.min.x() <= max.x() && min.y() <= b.max.y() && b.min.y() <= max.y();
  }
  static Box around(const Vec2& center, double radius) {
    Box b;
    b.min = center.array() - radius;
    b.max = center.array() + radius;
    return b;
  }
};

/// A closed chain of vertices; the last is joined to the first.
using Ring = std::vector<Vec2>;

/// A floor plan or a block: the even-odd region of its contours, extruded over a z interval.
/// Edges of every contour are met by rays from both sides.
struct Solid {
  std::vector<Ring> contours;
  ZInterval z;

  friend bool operator==(const Solid&, const Solid&) = default;
};

/// Of all contours.
std::size_t count_vertices(const std::vector<Solid>& solids);
/// The solid of a body that stands at this pose, in the world's frame.
Solid placed(Solid solid, const Pose& pose_world_body);

/// A convex polygon, counter-clockwise, extruded over a z interval.
struct ConvexPrism {
  Ring outline;
  ZInterval z;
};

double signed_area(const Ring& ring);
Box bounds(const Ring& ring);
/// True when each vertex turns left or goes straight on (to 1e-9 rad, since corners on one line rarely stay
/// on it in floating point), and the ring winds once. False for a clockwise ring and for one without area.
bool is_convex(const Ring& ring);
/// Smallest distance between two parallel lines that enclose the convex, counter-clockwise ring; 0 without
/// area.
double convex_width(const Ring& ring);
/// True when an odd number of contours wind around the point; points on an edge may go either way.
bool contains(const Solid& solid, const Vec2& point);

/// Convex pieces that together cover the even-odd region of a solid and overlap in no area.
/// A convex contour comes back whole; others are cut into trapezoids between horizontal lines and merged
/// where the union stays convex. Contours may cross, touch and coincide; corners are moved by at most 1e-12
/// of the largest coordinate. Empty when the region has no area. A fixed order: from the bottom up, then from
/// left to right.
/// Throws std::length_error where the contours cross so often that it would take more than seconds.
std::vector<ConvexPrism> convex_pieces(const Solid& solid);

}  // namespace troupe
