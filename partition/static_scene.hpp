#pragma once

#include "base/geometry.hpp"
#include "base/ids.hpp"
#include "partition/overlap.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace troupe::partition {

/// A solid that never moves, already in the world's frame.
struct FixedSolid {
  Solid solid;
  BodyId body;
  bool obstacle = true;
  float ranger_return = 1;
};

/// What never moves, kept as edges in the cells of a sparse grid.
class StaticScene {
 public:
  StaticScene() = default;
  /// cell_m never changes an answer.
  StaticScene(std::vector<FixedSolid> solids, double cell_m);

  const Box& bounds() const { return bounds_; }
  std::size_t edge_count() const { return edge_count_; }

  /// True when the shape shares area with an obstacle: an edge crosses it, or it lies wholly inside one.
  bool blocked(const ObstacleShape& shape, const Pose& pose_world_body) const;
  /// Bodies whose obstacle solids overlap the shape at this pose, ascending, without repeats.
  std::vector<BodyId> overlapping(const ObstacleShape& shape, const Pose& pose_world_body) const;

 private:
  Box bounds_;
  std::size_t edge_count_ = 0;
};

}  // namespace troupe::partition
