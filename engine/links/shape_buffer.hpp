#pragma once

#include "engine/kinds/mount.hpp"
#include "partition/overlap.hpp"

#include <cstddef>
#include <vector>

namespace troupe::engine {

/// An obstacle shape (the shape of a body for tests of overlaps) that is rebuilt often, from convex pieces:
/// call begin(), then add() for each piece, then finish(). The buffer keeps its memory. After reserve(), it
/// allocates only if a shape has more pieces, or a piece has more corners, than reserved.
class ShapeBuffer {
 public:
  /// The shape that the last finish() completed, empty before; valid until the next call of begin().
  const partition::ObstacleShape& shape() const { return shape_; }

  /// Allocates memory for shapes of up to `pieces` pieces, each with up to `corners` corners. Call this
  /// before the first begin(); a later call with more corners does not enlarge existing pieces.
  void reserve(std::size_t pieces, std::size_t corners);
  void begin();  ///< removes all pieces, keeps their memory
  /// Adds a convex piece of a body. The piece is given in the body's frame; `mount` is the body's frame
  /// relative to the frame of the shape.
  void add(const ConvexPrism& piece, const Mount& mount);
  /// Completes the shape. thinnest: the value for ObstacleShape::thinnest, the smallest width of any piece,
  /// m; infinity if there are no pieces
  void finish(double thinnest);

 private:
  partition::ObstacleShape shape_;
  std::size_t used_ = 0;     // number of pieces of the present shape
  std::vector<Ring> spare_;  // outlines of removed pieces, for reuse
};

}  // namespace troupe::engine
