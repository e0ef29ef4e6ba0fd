#pragma once

#include "engine/mount.hpp"
#include "partition/overlap.hpp"

#include <cstddef>
#include <vector>

namespace troupe::engine {

/// An obstacle shape that is rebuilt often, from convex pieces. It keeps its memory: it allocates only if a
/// shape has more pieces, or a piece more corners, than any before and than reserve() was called for.
class ShapeBuffer {
 public:
  /// The shape that finish() completed; valid until begin().
  const partition::ObstacleShape& shape() const { return shape_; }

  /// Allocates memory for a number of pieces of up to `corners` corners.
  void reserve(std::size_t pieces, std::size_t corners);
  void begin();  ///< removes all pieces, keeps their memory
  /// Adds a piece of a body, given in the body's frame. `mount` is that frame relative to the shape's frame.
  void add(const ConvexPrism& piece, const Mount& mount);
  /// Completes the shape. `thinnest` is the smallest width of any piece, m.
  void finish(double thinnest);

 private:
  partition::ObstacleShape shape_;
  std::size_t used_ = 0;     // pieces
  std::vector<Ring> spare_;  // outlines of removed pieces, for reuse
};

}  // namespace troupe::engine
