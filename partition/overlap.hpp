#pragma once

#include "base/geometry.hpp"

#include <span>
#include <vector>

namespace troupe::partition {

/// A circle that encloses a piece, m, frame of its shape.
struct PieceCircle {
  Vec2 centre;    ///< of the box about the piece's corners
  double radius;  ///< to the farthest of them
};
/// That of an outline of at least one corner.
PieceCircle circle_about(const Ring& outline);

/// A body as the overlap predicate sees it: convex prisms in the body's frame.
struct ObstacleShape {
  std::vector<ConvexPrism> pieces;   ///< in any order; together they are the body
  std::vector<PieceCircle> circles;  ///< of the pieces
  std::size_t vertices = 0;          ///< of all pieces
  double radius = 0;                 ///< of the circle about the body's origin that encloses every piece, m
  double thinnest = 0;               ///< smallest width of any piece, m
  ZInterval z;                       ///< of all pieces

  bool empty() const { return pieces.empty(); }  ///< whether it blocks no body
};

/// What bounds are widened by, m, so that no cull leaves out what the predicate would find: well above the
/// rounding of a corner's position, 1.5e-11 m at 100 km from the origin.
inline constexpr double k_rounding_m = 1e-9;

/// Prepares a shape from the obstacle solids of a body.
ObstacleShape make_obstacle_shape(std::span<const ConvexPrism> pieces);

/// True when the two bodies share area at a common height; touching is not overlap.
/// Exact polygon against polygon (separating axes), in double. The caller passes the body with the lower id
/// first, so that the bits of the answer do not depend on who asks.
bool overlap(const ObstacleShape& a, const Pose& pose_world_a, const ObstacleShape& b,
             const Pose& pose_world_b);

}  // namespace troupe::partition
