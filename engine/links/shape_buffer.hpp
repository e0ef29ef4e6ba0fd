#pragma once

#include "engine/kinds/mount.hpp"
#include "partition/overlap.hpp"

#include <cstddef>
#include <vector>

namespace troupe::engine {

/// Builds obstacle shapes, one at a time, in memory that is reused. An obstacle shape is the shape of a body,
/// or of several bodies that move together, in tests of overlap. It consists of convex pieces. To build a
/// shape, call begin(), then add() for each piece, then finish(). After reserve(), memory is allocated only
/// for a shape with more pieces, or a piece with more corners, than reserved.
class ShapeBuffer {
 public:
  /// The shape that the last finish() completed; an empty shape before the first finish(). Valid until the
  /// next call of begin().
  const partition::ObstacleShape& shape() const { return shape_; }

  /// Allocates memory for shapes of up to `pieces` pieces with up to `corners` corners each. Call this before
  /// the first begin(). A later call can reserve memory for more pieces, but not for more corners of the
  /// pieces that were reserved before.
  void reserve(std::size_t pieces, std::size_t corners);
  void begin();  ///< begins an empty shape; keeps the memory of the old pieces
  /// Adds a convex piece. `mount` transforms `piece` to the frame of the shape. If `piece` is given in the
  /// frame of a body, `mount` is that frame relative to the frame of the shape.
  void add(const ConvexPrism& piece, const Mount& mount);
  /// Completes the shape.
  ///
  /// thinnest: the width of the thinnest piece, m, or a lower bound on it; infinity if there are no pieces.
  /// It becomes ObstacleShape::thinnest.
  void finish(double thinnest);

 private:
  partition::ObstacleShape shape_;
  std::size_t used_ = 0;     // number of pieces of the present shape
  std::vector<Ring> spare_;  // outlines of removed pieces, for reuse
};

}  // namespace troupe::engine
