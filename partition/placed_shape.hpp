#pragma once

#include "partition/overlap.hpp"

#include <array>
#include <span>
#include <vector>

namespace troupe::partition {

/// True when two convex counter-clockwise polygons share area.
bool convex_overlap(std::span<const Vec2> a, std::span<const Vec2> b);

/// True when the segment enters the interior of a convex counter-clockwise polygon.
bool segment_overlap(const Vec2& s0, const Vec2& s1, std::span<const Vec2> polygon);

/// The vertices of a shape at a pose, in the world's frame: piece after piece. Bodies of up to 128 vertices,
/// nearly all, live on the stack.
class PlacedShape {
 public:
  PlacedShape(const ObstacleShape& shape, const Pose& pose_world_body);
  PlacedShape(const PlacedShape&) = delete;
  PlacedShape& operator=(const PlacedShape&) = delete;

  const Vec2* vertices() const { return begin_; }

 private:
  std::array<Vec2, 128> small_;
  std::vector<Vec2> large_;
  const Vec2* begin_;
};

}  // namespace troupe::partition
