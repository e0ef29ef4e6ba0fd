#pragma once

#include "engine/mount.hpp"
#include "partition/overlap.hpp"

#include <cstddef>
#include <vector>

namespace troupe::engine {

/// An obstacle shape that is rebuilt often, from pieces at given mounts. It keeps its memory, so that it
/// allocates only for more pieces, or more corners of a piece, than ever before or than were reserved.
class ShapeBuffer {
 public:
  /// The shape that finish() completed; valid until begin().
  const partition::ObstacleShape& shape() const { return shape_; }

  /// Allocates memory for a number of pieces of up to `corners` corners.
  void reserve(std::size_t pieces, std::size_t corners);
  void begin();  ///< removes all pieces, keeps their memory
  /// Adds a piece of another body; `mount` places that body's frame in the shape's.
  void add(const ConvexPrism& piece, const Mount& mount);
  /// Completes the shape. thinnest: smallest width of any piece, m, which no mount changes.
  void finish(double thinnest);

 private:
  partition::ObstacleShape shape_;
  std::size_t used_ = 0;     // pieces
  std::vector<Ring> spare_;  // outlines of removed pieces, for reuse
};

}  // namespace troupe::engine
