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
  double min = 0;  ///< lower end
  double max = 0;  ///< upper end; an interval with max < min holds nothing

  bool contains(double z) const { return min <= z && z <= max; }  ///< ends included
  /// Bodies that only touch do not overlap.
  bool overlaps(const ZInterval& other) const { return min < other.max && other.min < max; }
  ZInterval shifted(double dz) const { return {min + dz, max + dz}; }  ///< moved up by dz metres
  friend bool operator==(const ZInterval&, const ZInterval&) = default;
};

/// Axis-aligned box. Empty (min > max) until extended.
struct Box {
  /// The corner with the least x and y; metres, in the frame of what was put in.
  Vec2 min{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Vec2 max{-std::numeric_limits<double>::infinity(),
           -std::numeric_limits<double>::infinity()};  ///< the opposite corner

  /// True until extended; a box around one point is not empty.
  bool empty() const { return min.x() > max.x() || min.y() > max.y(); }
  // By coordinates, here and below: nearly every source includes this, and would instantiate Eigen's
  // expressions.
  /// Lengths along x and y; of an empty box meaningless.
  Vec2 size() const { return {max.x() - min.x(), max.y() - min.y()}; }
  /// Of an empty box NaN.
  Vec2 center() const { return {0.5 * (min.x() + max.x()), 0.5 * (min.y() + max.y())}; }
  /// Grows the box to hold the point.
  void extend(const Vec2& p) {
    min = {std::min(min.x(), p.x()), std::min(min.y(), p.y())};
    max = {std::max(max.x(), p.x()), std::max(max.y(), p.y())};
  }
  /// Grows the box to hold the other one; an empty one changes nothing.
  void extend(const Box& b) {
    min = {std::min(min.x(), b.min.x()), std::min(min.y(), b.min.y())};
    max = {std::max(max.x(), b.max.x()), std::max(max.y(), b.max.y())};
  }
  /// Grown by the margin on all four sides; a negative one shrinks it, perhaps to an empty box.
  Box expanded(double margin) const {
    Box b;
    b.min = {min.x() - margin, min.y() - margin};
    b.max = {max.x() + margin, max.y() + margin};
    return b;
  }
  /// The border is inside.
  bool contains(const Vec2& p) const {
    return min.x() <= p.x() && p.x() <= max.x() && min.y() <= p.y() && p.y() <= max.y();
  }
  /// True when the closed boxes meet.
  bool touches(const Box& b) const {
    return min.x() <= b.max.x() && b.min.x() <= max.x() && min.y() <= b.max.y() && b.min.y() <= max.y();
  }
  /// The square with this centre and half this side: the bounds of a circle.
  static Box around(const Vec2& center, double radius) {
    Box b;
    b.min = {center.x() - radius, center.y() - radius};
    b.max = {center.x() + radius, center.y() + radius};
    return b;
  }
};

/// A closed chain of vertices; the last is joined to the first.
using Ring = std::vector<Vec2>;

/// A floor plan or a block: the even-odd region of its contours, extruded over a z interval.
/// Edges of every contour are met by rays from both sides.
struct Solid {
  std::vector<Ring> contours;  ///< outer and inner ones alike, in any order and direction
  ZInterval z;                 ///< the heights it fills, in the frame of the contours

  friend bool operator==(const Solid&, const Solid&) = default;
};

/// Of all contours.
std::size_t count_vertices(const std::vector<Solid>& solids);
/// The solid of a body that stands at this pose, in the world's frame.
Solid placed(Solid solid, const Pose& pose_world_body);

/// A convex polygon, counter-clockwise, extruded over a z interval.
struct ConvexPrism {
  Ring outline;  ///< at least three corners, in the frame of the solid it was cut from
  ZInterval z;   ///< that of the solid
};

/// Square metres; positive for a counter-clockwise ring, 0 for fewer than three vertices.
double signed_area(const Ring& ring);
/// The smallest box that holds every vertex; empty for a ring without vertices.
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
