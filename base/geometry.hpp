#pragma once

#include "base/pose.hpp"

#include <algorithm>
#include <limits>
#include <vector>

namespace troupe {

/// The z component of the cross product a x b: positive if b lies counter-clockwise of a.
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// A closed interval of heights, metres.
struct ZInterval {
  double min = 0;  ///< lower end
  double max = 0;  ///< upper end; an interval with max < min is empty

  bool contains(double z) const { return min <= z && z <= max; }  ///< whether z is inside; ends count
  /// True if each of the two intervals begins below the upper end of the other. Intervals that only touch at
  /// their ends do not overlap. If one of the intervals is empty, the result has no meaning.
  bool overlaps(const ZInterval& other) const { return min < other.max && other.min < max; }
  ZInterval shifted(double dz) const { return {min + dz, max + dz}; }  ///< moved up by dz metres
  friend bool operator==(const ZInterval&, const ZInterval&) = default;
};

/// Axis-aligned box in the plane, metres. A default-constructed box, called a new box below, is empty until
/// extend() is called: min is +infinity, max is -infinity.
struct Box {
  /// The corner with the least x and y, metres, in the frame of the points that extend the box.
  Vec2 min{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Vec2 max{-std::numeric_limits<double>::infinity(),
           -std::numeric_limits<double>::infinity()};  ///< the corner with the greatest x and y

  /// True if min exceeds max in x or y, as in a new box. A box around a single point is not empty.
  bool empty() const { return min.x() > max.x() || min.y() > max.y(); }
  // This function and those below compute each coordinate by itself. With Eigen's expressions nearly every
  // source file would instantiate Eigen's templates, which makes compiling slow.
  /// Lengths along x and y; meaningless for an empty box.
  Vec2 size() const { return {max.x() - min.x(), max.y() - min.y()}; }
  /// The centre; NaN for a new box, meaningless for any other empty box.
  Vec2 center() const { return {0.5 * (min.x() + max.x()), 0.5 * (min.y() + max.y())}; }
  /// Grows the box to contain the point.
  void extend(const Vec2& p) {
    min = {std::min(min.x(), p.x()), std::min(min.y(), p.y())};
    max = {std::max(max.x(), p.x()), std::max(max.y(), p.y())};
  }
  /// Grows this box to contain the box `b`. If `b` is a new box, nothing changes; no other empty box is
  /// allowed.
  void extend(const Box& b) {
    min = {std::min(min.x(), b.min.x()), std::min(min.y(), b.min.y())};
    max = {std::max(max.x(), b.max.x()), std::max(max.y(), b.max.y())};
  }
  /// Returns a copy of the box in which each of the four sides is moved outwards by the margin, in metres. A
  /// negative margin moves the sides inwards; the copy may then be empty.
  Box expanded(double margin) const {
    Box b;
    b.min = {min.x() - margin, min.y() - margin};
    b.max = {max.x() + margin, max.y() + margin};
    return b;
  }
  /// True if the point is inside the box or on its border.
  bool contains(const Vec2& p) const {
    return min.x() <= p.x() && p.x() <= max.x() && min.y() <= p.y() && p.y() <= max.y();
  }
  /// True if the boxes overlap or touch. False if one of them is a new box.
  bool touches(const Box& b) const {
    return min.x() <= b.max.x() && b.min.x() <= max.x() && min.y() <= b.max.y() && b.min.y() <= max.y();
  }
  /// The bounding box of the circle with this centre and radius, m; empty for a negative radius.
  static Box around(const Vec2& center, double radius) {
    Box b;
    b.min = {center.x() - radius, center.y() - radius};
    b.max = {center.x() + radius, center.y() + radius};
    return b;
  }
};

/// A closed polygon, metres; the last vertex is joined to the first.
using Ring = std::vector<Vec2>;

/// A region of the plane, extruded over a z interval: a part of a robot, an obstacle, or the walls of a floor
/// plan. Closed polygons, the contours, bound the region. A point is in the region if a ray from the point
/// crosses the contours an odd number of times (the even-odd rule). A contour inside another contour is
/// therefore a hole. Rays of sensors hit the edges of every contour from both sides.
struct Solid {
  std::vector<Ring> contours;  ///< outer and inner contours, in any order and direction
  ZInterval z;                 ///< the heights that the solid fills, in the frame of the contours

  friend bool operator==(const Solid&, const Solid&) = default;
};

/// Number of vertices of all contours of all solids.
std::size_t count_vertices(const std::vector<Solid>& solids);
/// Returns a solid, given in the frame of a body, in the world frame. The contours are moved and turned by
/// the pose of the body, and the heights are shifted by the z of the pose.
Solid placed(Solid solid, const Pose& pose_world_body);

/// A convex polygon, counter-clockwise, extruded over a z interval.
struct ConvexPrism {
  Ring outline;  ///< at least three corners, in the frame of the solid that it was cut from
  ZInterval z;   ///< the heights of the solid that it was cut from
};

/// The area of a ring, square metres: positive for a counter-clockwise ring, negative for a clockwise one, 0
/// for fewer than three vertices.
double signed_area(const Ring& ring);
/// The smallest box that contains every vertex; empty for a ring without vertices.
Box bounds(const Ring& ring);
/// True if the ring is convex and counter-clockwise: it winds once, and turns left or goes straight on at
/// every vertex. A right turn of up to 1e-9 rad counts as straight on, because rounding moves collinear
/// corners off their line. False for a ring without area.
bool is_convex(const Ring& ring);
/// The smallest distance, metres, between two parallel lines that enclose the ring; 0 for a ring without
/// area. The ring must be convex and counter-clockwise.
double convex_width(const Ring& ring);
/// True if the edge from `a` to `b` crosses the ray that starts at the point and runs along +x. A point is
/// inside a polygon if its ray crosses an odd number of edges. An end of an edge with the y of the point
/// counts as below the ray, so that this also holds for rays through vertices. For a point on the edge, the
/// result may be true or false.
inline bool crosses_ray(const Vec2& a, const Vec2& b, const Vec2& point) {
  const bool a_above = a.y() > point.y();
  if (a_above == (b.y() > point.y())) return false;
  // The edge is to the right of the point if the point is to the left of the edge, seen in its upward
  // direction.
  const double side = cross(b - a, point - a);
  return a_above ? side < 0 : side > 0;
}
/// The squared distance, square metres, from a point to the segment from `a` to `b`. If the segment is so
/// short that its squared length is 0 after rounding, this is the squared distance to `a`.
inline double squared_distance_to_segment(const Vec2& point, const Vec2& a, const Vec2& b) {
  const double along_x = b.x() - a.x(), along_y = b.y() - a.y();
  const double from_x = point.x() - a.x(), from_y = point.y() - a.y();
  const double length2 = along_x * along_x + along_y * along_y;
  const double t = length2 > 0 ? std::clamp((from_x * along_x + from_y * along_y) / length2, 0.0, 1.0) : 0.0;
  const double x = from_x - t * along_x, y = from_y - t * along_y;
  return x * x + y * y;
}
/// The distance, metres, between the segments from `a` to `b` and from `c` to `d`; 0 if they cross.
inline double segment_distance(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const auto differ = [](double x, double y) { return (x < 0 && y > 0) || (x > 0 && y < 0); };
  if (differ(cross(b - a, c - a), cross(b - a, d - a)) && differ(cross(d - c, a - c), cross(d - c, b - c)))
    return 0;
  return sqrt(std::min({squared_distance_to_segment(a, c, d), squared_distance_to_segment(b, c, d),
                        squared_distance_to_segment(c, a, b), squared_distance_to_segment(d, a, b)}));
}
/// True if the point is inside the solid by the even-odd rule. The point is given in the frame of the
/// contours; heights are ignored. For a point on an edge, the result may be true or false.
bool contains(const Solid& solid, const Vec2& point);

/// A width, metres. Collision tests are slow for a body whose shape has a convex piece that is narrower than
/// this. The reason is that the motion of a body is tested in steps of a quarter of the width of its
/// narrowest piece.
inline constexpr double k_thin_m = 0.5e-3;

/// Cuts the region of a solid into convex pieces that do not overlap. The contours of the solid may cross,
/// touch and coincide.
///
/// A single convex contour is returned whole, counter-clockwise and without repeated corners. Any other
/// region is cut along lines parallel to the x axis into trapezoids; trapezoids are merged where their union
/// is convex. If a piece is narrower than k_thin_m, the function also tries cuts parallel to the y axis and,
/// if necessary, parallel to a diagonal. It returns the pieces of the direction whose narrowest piece is
/// widest.
///
/// Cutting moves corners by at most 1e-12 of the largest coordinate. If the cuts are parallel to the x axis,
/// the pieces are ordered by their lowest y, and pieces with the same lowest y from left to right. Returns no
/// pieces if the region has no area. Throws std::length_error if cutting would take longer than a few
/// seconds, because the contours have too many long edges or too many crossings.
std::vector<ConvexPrism> convex_pieces(const Solid& solid);

}  // namespace troupe
