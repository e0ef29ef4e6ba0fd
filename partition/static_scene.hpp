#pragma once

#include "base/geometry.hpp"
#include "base/ids.hpp"
#include "partition/box_grid.hpp"
#include "partition/fixed_outlines.hpp"
#include "partition/overlap.hpp"
#include "partition/placed_shape.hpp"
#include "partition/sparse_grid.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace troupe::partition {

/// A solid that never moves, already in the world's frame.
struct FixedSolid {
  Solid solid;              ///< world frame
  BodyId body;              ///< whose it is
  bool obstacle = true;     ///< blocks motions
  float ranger_return = 1;  ///< intensity that rangers read; below 0: they pass it
  std::uint32_t part = 0;   ///< of the body
};

/// Edges by the cells they cross. An edge lies whole in each of its cells: clipping would change bits, and
/// meeting one twice is harmless.
class EdgeGrid {
 public:
  EdgeGrid() = default;
  /// How the cells are cut changes no answer.
  EdgeGrid(std::span<const FixedEdge> edges, const GridGeometry& geometry);

  /// visit(span of edges) for each run of cells that touches the box; an edge may come more than once.
  template <class Visit>
  void for_each_run(const Box& box, Visit&& visit) const {
    if (edges_.empty()) return;
    partition::for_each_run(geometry_, directory_, box,
                            [&](std::uint32_t slot, std::size_t first, std::size_t last, Cell) {
                              const std::uint32_t* begin = &begins_[slot * geometry_.cells_per_tile()];
                              const std::uint32_t from = begin[first];
                              const std::uint32_t to = begin[last];
                              if (from < to) visit(std::span(&edges_[from], to - from));
                            });
  }

 private:
  GridGeometry geometry_;
  TileDirectory directory_;
  std::vector<std::uint32_t> begins_;  // per slot and cell, one closing entry: into edges_
  std::vector<FixedEdge> edges_;       // in (tile, cell) order
};

/// The static geometry. Answers rays, overlap and point-in-solid.
class StaticScene {
 public:
  StaticScene() = default;
  /// cell_m never changes an answer.
  StaticScene(std::vector<FixedSolid> solids, double cell_m);

  std::span<const FixedSolid> solids() const { return solids_; }  ///< in the order in which they were given
  const Box& bounds() const { return bounds_; }                   ///< of all of them; empty without any
  std::size_t edge_count() const { return edge_count_; }          ///< edges of all solids

  /// What rangers see.
  const FixedOutlines& outlines() const { return outlines_; }
  /// What rangers do not see, and other sensors do.
  const FixedOutlines& hidden_outlines() const { return hidden_outlines_; }
  bool has_obstacles() const { return has_obstacles_; }  ///< whether any of them blocks motions

  /// The first obstacle solid an edge of which crosses the shape and that `ignored` does not name; -1: none.
  /// A shape wholly inside a solid crosses no edge: see blocked().
  template <class Ignored>
  int crossed(const PlacedShape& shape, Ignored&& ignored) const;

  /// Distance from a point to the nearest edge of an obstacle, m, whatever its height; at most `most`.
  double clearance(const Vec2& point, double most) const;
  /// True when the shape shares area with this obstacle solid.
  bool overlaps_solid(std::size_t solid, const PlacedShape& shape) const;
  /// True when the shape shares area with an obstacle: an edge crosses it, or it lies wholly inside one.
  bool blocked(const ObstacleShape& shape, const Pose& pose_world_body) const;
  /// Bodies whose obstacle solids overlap the shape at this pose, ascending, without repeats.
  std::vector<BodyId> overlapping(const ObstacleShape& shape, const Pose& pose_world_body) const;

 private:
  /// Edges of one solid by horizontal strips, for counting crossings of a ray towards -x; and what is known
  /// of the cells of its box beforehand, so that few points have their crossings counted.
  struct Strips {
    enum Cover : std::uint8_t { unknown, outside, inside };  // unknown: an edge may cross the cell

    Box box;
    Cell low;                   // of the cells
    std::size_t width = 0;      // cells a row
    std::vector<Cover> covers;  // of the cells, row by row; none where they would be too many
    double y0 = 0;
    double height = 1;
    std::vector<std::uint32_t> begins;
    std::vector<FixedEdge> edges;
  };
  bool inside(std::size_t solid, const Vec2& point) const;
  bool count_crossings(const Strips& strips, const Vec2& point) const;
  void cover_cells(const Solid& solid, Strips& strips) const;
  /// Whether one of the pieces lies wholly inside the solid, where no edge of the solid crosses the shape.
  bool swallows(std::size_t solid, const PlacedShape& shape) const;
  /// visit(solid) -> stop? for those that swallow a piece of the shape, more than once perhaps.
  template <class Visit>
  bool find_swallowing(const PlacedShape& shape, Visit&& visit) const {
    return boxes_.any_near(Box::around(shape.position(), shape.shape().radius),
                           [&](std::uint32_t solid) { return swallows(solid, shape) && visit(solid); });
  }
  /// visit(edge) -> stop? for obstacle edges that cross the shape.
  template <class Visit>
  bool find_crossing(const PlacedShape& shape, Visit&& visit) const;

  std::vector<FixedSolid> solids_;
  std::vector<Strips> strips_;  // beside solids_; empty where the solid is no obstacle
  BoxGrid boxes_;               // of the strips
  Box bounds_;
  std::size_t edge_count_ = 0;
  bool has_obstacles_ = false;
  FixedOutlines outlines_;
  FixedOutlines hidden_outlines_;
  GridGeometry cover_grid_;
  EdgeGrid obstacle_edges_;
};

template <class Visit>
bool StaticScene::find_crossing(const PlacedShape& placed, Visit&& visit) const {
  Box box;
  placed.any_piece([&](const ConvexPrism&, const auto& polygon) {
    for (std::size_t i = 0; i < polygon.size(); ++i) box.extend(polygon[i]);
    return false;
  });
  bool stop = false;
  obstacle_edges_.for_each_run(box, [&](std::span<const FixedEdge> edges) {
    for (const FixedEdge& edge : edges) {
      if (stop) return;
      if (edge.a.cwiseMin(edge.b).x() > box.max.x() || edge.a.cwiseMax(edge.b).x() < box.min.x() ||
          edge.a.cwiseMin(edge.b).y() > box.max.y() || edge.a.cwiseMax(edge.b).y() < box.min.y())
        continue;
      const ZInterval z = solids_[edge.solid].solid.z;
      stop = placed.any_piece([&](const ConvexPrism& piece, const auto& polygon) {
        return piece.z.shifted(placed.z()).overlaps(z) && segment_overlap(edge.a, edge.b, polygon);
      }) && visit(edge);
    }
  });
  return stop;
}

template <class Ignored>
int StaticScene::crossed(const PlacedShape& shape, Ignored&& ignored) const {
  int hit = -1;
  find_crossing(shape, [&](const FixedEdge& edge) {
    if (ignored(edge.solid)) return false;
    hit = static_cast<int>(edge.solid);
    return true;
  });
  return hit;
}

}  // namespace troupe::partition
