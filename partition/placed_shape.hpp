#pragma once

#include "partition/overlap.hpp"

#include <array>
#include <span>

namespace troupe::partition {

/// A ring that stands somewhere, its vertices worked out as they are asked for.
class PlacedRing {
 public:
  /// Both must outlive it.
  PlacedRing(const Ring& ring, const Transform& transform) : ring_(ring), transform_(transform) {}
  std::size_t size() const { return ring_.size(); }  ///< vertices
  /// The i-th, where the ring stands.
  Vec2 operator[](std::size_t i) const { return transform_ * ring_[i]; }

 private:
  const Ring& ring_;
  const Transform& transform_;
};

/// True when two convex counter-clockwise polygons share area.
bool convex_overlap(std::span<const Vec2> a, std::span<const Vec2> b);

/// True when the segment enters the interior of a convex counter-clockwise polygon.
bool segment_overlap(const Vec2& s0, const Vec2& s1, std::span<const Vec2> polygon);
/// The same of a ring whose vertices are worked out on the way.
bool segment_overlap(const Vec2& s0, const Vec2& s1, const PlacedRing& polygon);

/// A shape at a place. The vertices of shapes of up to 128, nearly all, are worked out once, on the stack;
/// those of larger ones each time they are looked at, so that no shape needs the heap.
class PlacedShape {
 public:
  /// The shape must outlive this. z: height of its frame, m.
  PlacedShape(const ObstacleShape& shape, const Transform& transform_world_body, double z);
  /// The shape must outlive this.
  PlacedShape(const ObstacleShape& shape, const Pose& pose_world_body)
      : PlacedShape(shape, Transform(pose_world_body), pose_world_body.z) {}
  PlacedShape(const PlacedShape&) = delete;
  PlacedShape& operator=(const PlacedShape&) = delete;

  const ObstacleShape& shape() const { return shape_; }         ///< what stands there
  const Transform& transform() const { return transform_; }     ///< of its frame in the world
  const Vec2& position() const { return transform_.position; }  ///< of its frame's origin, m, world frame
  double z() const { return z_; }                               ///< height of its frame, m

  /// visit(piece, its polygon in the world's frame: a span of vertices or a PlacedRing) -> stop?, for each
  /// piece until one stops; says whether one did.
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

 private:
  const ObstacleShape& shape_;
  Transform transform_;
  double z_;
  std::array<Vec2, 128> vertices_;  // piece after piece, where they fit
};

/// overlap() of shapes that are placed already.
bool overlap(const PlacedShape& a, const PlacedShape& b);

/// False only when no piece of one shape comes within `distance` (m) of a piece of the other: a look at the
/// circles about the pieces, whatever their heights.
bool pieces_in_reach(const ObstacleShape& a, const Transform& at_a, const ObstacleShape& b,
                     const Transform& at_b, double distance);

/// False only when shapes of these radii, at these places, do not overlap: the first thing overlap() asks.
inline bool in_reach(const Vec2& a, double radius_a, const Vec2& b, double radius_b) {
  const double reach = radius_a + radius_b + k_rounding_m;
  const double dx = b.x() - a.x();
  const double dy = b.y() - a.y();
  return dx * dx + dy * dy <= reach * reach;
}

}  // namespace troupe::partition
