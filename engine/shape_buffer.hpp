#pragma once

#include "engine/mount.hpp"
#include "partition/overlap.hpp"

#include <cstddef>
#include <vector>

namespace troupe::engine {

/// An obstacle shape that is made again and again, of pieces that stand somewhere. What memory it once took
/// it keeps: it allocates when it has more pieces, or one with more corners, than ever before, or than there
/// is room for.
class ShapeBuffer {
 public:
  /// As finish() left it; valid until begin().
  const partition::ObstacleShape& shape() const { return shape_; }

  /// Makes room for so many pieces of up to so many corners.
  void reserve(std::size_t pieces, std::size_t corners);
  void begin();  ///< drops all pieces and keeps their memory
  /// Adds a piece of another body; `mount` places that body's frame in the shape's.
  void add(const ConvexPrism& piece, const Mount& mount);
  /// thinnest: the smallest width of any piece, m; moving a piece changes no width.
  void finish(double thinnest);

 private:
  partition::ObstacleShape shape_;
  std::size_t used_ = 0;     // pieces
  std::vector<Ring> spare_;  // outlines of pieces that were given up
};

}  // namespace troupe::engine
