#pragma once

#include "base/geometry.hpp"

#include <span>
#include <vector>

namespace troupe::partition {

/// A circle that encloses a piece (a convex prism) of a shape, metres, in the frame of the shape.
struct PieceCircle {
  Vec2 centre;    ///< centre of the piece's bounding box
  double radius;  ///< distance from the centre to the piece's farthest corner
};
/// The circle that encloses an outline, about the centre of its bounding box, metres, in the frame of the
/// outline. The outline must have at least one corner.
PieceCircle circle_about(const Ring& outline);

/// The shape of a body for tests of overlap: convex prisms, called pieces, in the body frame.
struct ObstacleShape {
  std::vector<ConvexPrism> pieces;   ///< in any order; their union is the body
  std::vector<PieceCircle> circles;  ///< enclosing circles, one per piece
  std::size_t vertices = 0;          ///< number of vertices of all pieces
  double radius = 0;  ///< radius of the circle about the body's origin that encloses the body, m
  /// Smallest width of any piece (convex_width()), m. make_obstacle_shape() sets it to 0 if there are no
  /// pieces.
  double thinnest = 0;
  ZInterval z;  ///< the interval that encloses the heights of all pieces, body frame, m

  bool empty() const { return pieces.empty(); }  ///< true if the body blocks nothing
};

/// A margin for rounding errors, metres. Fast tests discard pairs of shapes that are too far apart to
/// overlap. The tests add this margin to the radii of the shapes, so that no pair for which overlap() is true
/// is discarded. The margin is far above the rounding error of the position of a corner, which is 1.5e-11 m
/// at 100 km from the origin.
inline constexpr double k_rounding_m = 1e-9;

/// Makes a shape from the convex pieces of a body's obstacle solids (convex_pieces()), body frame, m.
ObstacleShape make_obstacle_shape(std::span<const ConvexPrism> pieces);

/// Returns the shape with every edge of every piece moved inwards by `depth`, m; heights do not change. A
/// body that penetrates the shape by at most `depth` does not overlap the result. Edges of a piece narrower
/// than twice `depth` would cross over, so `depth` should be less than half of ObstacleShape::thinnest.
ObstacleShape inset(const ObstacleShape& shape, double depth);

/// True if the two shapes overlap: a piece of one shape and a piece of the other share area, seen from above,
/// and their intervals of heights overlap. Shapes that only touch do not overlap. The caller must pass the
/// shape of the body with the lower id (number of the body in the world) as `a`. Rounding then gives the same
/// result whichever of the two bodies moves.
bool overlap(const ObstacleShape& a, const Pose& pose_world_a, const ObstacleShape& b,
             const Pose& pose_world_b);

}  // namespace troupe::partition
