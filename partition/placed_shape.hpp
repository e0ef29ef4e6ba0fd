#pragma once

#include "partition/overlap.hpp"

#include <array>
#include <span>

namespace troupe::partition {

/// A ring (closed polygon) whose vertices are transformed to another frame. Each access to a vertex computes
/// the transformed vertex again; nothing is stored.
class PlacedRing {
 public:
  /// transform: from the frame of the ring to the other frame. `ring` and `transform` must outlive the
  /// object.
  PlacedRing(const Ring& ring, const Transform& transform) : ring_(ring), transform_(transform) {}
  std::size_t size() const { return ring_.size(); }  ///< number of vertices
  /// The i-th vertex, transformed.
  Vec2 operator[](std::size_t i) const { return transform_ * ring_[i]; }

 private:
  const Ring& ring_;
  const Transform& transform_;
};

/// True if two convex counter-clockwise polygons in the same frame share area. Polygons that only touch share
/// no area.
bool convex_overlap(std::span<const Vec2> a, std::span<const Vec2> b);
/// True if two convex counter-clockwise polygons in the same frame share area. Polygons that only touch share
/// no area.
bool convex_overlap(std::span<const Vec2> a, const PlacedRing& b);

/// True if the segment from s0 to s1 enters the interior of a convex counter-clockwise polygon in the same
/// frame.
bool segment_overlap(const Vec2& s0, const Vec2& s1, std::span<const Vec2> polygon);
/// True if the segment from s0 to s1 enters the interior of a convex counter-clockwise polygon in the same
/// frame.
bool segment_overlap(const Vec2& s0, const Vec2& s1, const PlacedRing& polygon);

/// The shape of a body at a pose. A shape consists of convex prisms, called pieces (ObstacleShape). If the
/// shape has at most 128 vertices, the constructor transforms all vertices to the world frame and stores them
/// in this object. The vertices of larger shapes, which are rare, are transformed again at each access. This
/// object therefore needs no heap memory.
class PlacedShape {
 public:
  /// Places a shape, which must outlive the object. transform_world_body: from the frame of the shape to the
  /// world frame. z: height of the origin of the frame of the shape, metres, world frame.
  PlacedShape(const ObstacleShape& shape, const Transform& transform_world_body, double z);
  /// Places a shape, which must outlive the object. pose_world_body: pose of the shape in the world frame.
  PlacedShape(const ObstacleShape& shape, const Pose& pose_world_body)
      : PlacedShape(shape, Transform(pose_world_body), pose_world_body.z) {}
  PlacedShape(const PlacedShape&) = delete;
  PlacedShape& operator=(const PlacedShape&) = delete;

  const ObstacleShape& shape() const { return shape_; }         ///< the shape, in its own frame
  const Transform& transform() const { return transform_; }     ///< from its frame to the world frame
  const Vec2& position() const { return transform_.position; }  ///< origin of its frame, m, world frame
  double z() const { return z_; }                               ///< height of its frame, m, world frame

  /// Calls visit(piece, polygon) for each piece of the shape until a call returns true. Returns whether a
  /// call returned true.
  /// piece    the piece, in the frame of the shape (ConvexPrism)
  /// polygon  the vertices of the piece in the world frame: a span or a PlacedRing, so `visit` must accept
  ///          both
  template <class Visit>
  bool any_piece(Visit&& visit) const {
    const Vec2* vertices = vertices_.data();
    for (const ConvexPrism& piece : shape_.pieces) {
      if (shape_.vertices > vertices_.size()) {
        if (visit(piece, PlacedRing(piece.outline, transform_))) return true;
      } else {
        if (visit(piece, std::span<const Vec2>(vertices, piece.outline.size()))) return true;
        vertices += piece.outline.size();
      }
    }
    return false;
  }
  /// The circle that encloses a piece, metres, world frame. piece: an element of shape().pieces, such as
  /// any_piece() passes. The shape must have its circles (make_obstacle_shape()).
  PieceCircle circle_of(const ConvexPrism& piece) const {
    const PieceCircle& circle = shape_.circles[static_cast<std::size_t>(&piece - shape_.pieces.data())];
    return {transform_ * circle.centre, circle.radius};
  }

 private:
  const ObstacleShape& shape_;
  Transform transform_;
  double z_;
  std::array<Vec2, 128> vertices_;  // of all pieces, if they fit
};

/// Returns true if the shapes overlap: a piece of one shape and a piece of the other share area, seen from
/// above, and their intervals of heights overlap. Shapes that only touch do not overlap. The caller must pass
/// the shape of the body with the lower id (number of the body in the world) as `a`. Rounding then gives the
/// same result whichever of the two bodies moves.
bool overlap(const PlacedShape& a, const PlacedShape& b);

/// True if a piece of the shape is within `distance` (metres) of the segment from `a` to `b`, seen from
/// above, and its interval of heights overlaps `z`. The segment and `z` are in the world frame. A segment
/// inside a piece is at the distance 0.
bool is_near_segment(const PlacedShape& shape, const Vec2& a, const Vec2& b, double distance,
                     const ZInterval& z);

/// A fast test of whether two shapes may be close to each other. It compares only circles that enclose the
/// pieces and ignores heights. False: no piece of `a` comes within `distance` (metres) of a piece of `b`.
/// True: a piece may do so. at_a, at_b: from the frame of each shape to the world frame.
bool pieces_in_reach(const ObstacleShape& a, const Transform& at_a, const ObstacleShape& b,
                     const Transform& at_b, double distance);

/// A fast test of whether two shapes may overlap; overlap() begins with this test. False: the shapes do not
/// overlap. True: they may overlap. a, b: origins of the two shapes, metres, world frame. radius_a, radius_b:
/// radii of the circles about these origins that enclose the shapes, metres.
inline bool in_reach(const Vec2& a, double radius_a, const Vec2& b, double radius_b) {
  const double reach = radius_a + radius_b + k_rounding_m;
  const double dx = b.x() - a.x();
  const double dy = b.y() - a.y();
  return dx * dx + dy * dy <= reach * reach;
}

}  // namespace troupe::partition
