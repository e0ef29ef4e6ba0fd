#pragma once

#include "base/geometry.hpp"
#include "base/ids.hpp"
#include "partition/box_grid.hpp"
#include "partition/fixed_outlines.hpp"
#include "partition/overlap.hpp"
#include "partition/placed_shape.hpp"
#include "partition/sparse_grid.hpp"

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace troupe::partition {

/// A solid (a polygon, extruded over an interval of heights) of a body that never moves, such as a wall.
struct FixedSolid {
  Solid solid;           ///< the solid, world frame
  BodyId body;           ///< the body that the solid belongs to
  bool obstacle = true;  ///< whether the solid blocks motions; it is then called an obstacle
  /// Intensity that rangers (range sensors) read; negative: rangers do not see the solid.
  float ranger_return = 1;
  std::uint32_t part = 0;  ///< index of the solid's part in the list of parts of the body's type
};

/// A spatial index of edges: each cell of a grid lists the edges that cross the cell. The edges are not cut
/// at the borders of cells, because rounding errors of the cuts would change the bits of results.
class EdgeGrid {
 public:
  EdgeGrid() = default;
  /// Indexes the edges. geometry: the grid of the cells. It affects only the speed of searches: with larger
  /// cells, for_each_run() visits more edges that do not touch its box.
  EdgeGrid(std::span<const FixedEdge> edges, const GridGeometry& geometry);

  /// Calls visit(span of edges) for the edges in the cells that the box (metres, world frame) touches. An
  /// edge that crosses several of these cells is visited once per cell.
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
  TileDirectory directory_;            // gives each tile in use a number, its slot
  std::vector<std::uint32_t> begins_;  // per slot and cell, and one past the end: index into edges_
  std::vector<FixedEdge> edges_;       // in (tile, cell) order
};

/// The static scene: the solids that never move. It provides the outlines of the solids for rays, tests
/// whether the shape of a body overlaps a solid, and computes distances to solids. A default-constructed
/// scene has no solids.
///
/// Terms: An obstacle is a solid that blocks motions (FixedSolid::obstacle). The shape of a body consists of
/// convex prisms, called pieces (ObstacleShape); a PlacedShape is a shape at a pose. Two objects are at a
/// common height if their intervals of heights overlap.
class StaticScene {
 public:
  StaticScene() = default;
  /// solids: in the world frame. cell_m: a length, metres, above 0, from which this object derives the cell
  /// sizes of its grids. It affects only the speed. If very long edges cross too many cells, the cells are
  /// made larger, so that the memory stays within limits (docs/limits.md).
  StaticScene(std::vector<FixedSolid> solids, double cell_m);

  std::span<const FixedSolid> solids() const { return solids_; }  ///< all solids, in the order given
  const Box& bounds() const { return bounds_; }  ///< bounds of all solids, world frame, m; may be empty
  std::size_t edge_count() const { return edge_count_; }  ///< number of edges of all solids

  /// The outlines that rangers (range sensors) see.
  const FixedOutlines& outlines() const { return outlines_; }
  /// The outlines that rangers do not see, but other sensors do.
  const FixedOutlines& hidden_outlines() const { return hidden_outlines_; }
  bool has_obstacles() const { return has_obstacles_; }  ///< whether any solid blocks motions
  /// Calls visit(index in solids()), in any order, for each solid whose bounding box contains the point
  /// (metres, world frame). Heights are ignored.
  template <class Visit>
  void for_each_box_at(const Vec2& point, Visit&& visit) const {
    boxes_.any_near(Box::around(point, 0), [&](std::uint32_t solid) {
      if (strips_[solid].box.contains(point)) visit(solid);
      return false;
    });
  }

  /// Finds an obstacle with an edge that enters a piece of the shape at a common height. Returns the index of
  /// this obstacle in solids(), or -1 if there is none. If there are several, returns the one that the search
  /// finds first. Skips solids for which ignored(index in solids()) is true. Does not find a solid that
  /// contains the whole shape, because no edge of such a solid enters the shape; overlaps() finds it.
  template <class Ignored>
  int crossed(const PlacedShape& shape, Ignored&& ignored) const;

  /// The distance, metres, from a point (metres, world frame) to the nearest edge of an obstacle. If the
  /// distance is more than `most` (metres), the result is `most`. Heights are ignored. A point inside an
  /// obstacle also has a positive distance.
  double clearance(const Vec2& point, double most) const;
  /// True if the shape shares area with the obstacle solids()[solid] at a common height.
  bool overlaps_solid(std::size_t solid, const PlacedShape& shape) const;
  /// True if the shape shares area with an obstacle at a common height. False for a shape without pieces.
  bool overlaps(const PlacedShape& shape) const;
  /// Whether a motion takes a body deeper into an obstacle: partition::deepens() for the convex pieces of the
  /// obstacles. `before` and `after` are the shape of the body at the beginning and at the end of the motion.
  /// An obstacle whose outline is too complex for convex_pieces() counts as deeper wherever the body overlaps
  /// it.
  bool deepens(const PlacedShape& before, const PlacedShape& after) const;
  /// True if an obstacle of the body is within `distance` (metres) of the segment from `a` to `b`, seen from
  /// above, and its interval of heights overlaps `z`; all in the world frame. A segment inside an obstacle is
  /// at the distance 0.
  bool is_near_segment(BodyId body, const Vec2& a, const Vec2& b, double distance, const ZInterval& z) const;
  /// The body with the lowest id of whose obstacles one lets no shape go from `before` to `after`: the shape
  /// overlaps it afterwards, and did not before, or less deeply (deepens()). Not valid() if there is none.
  BodyId blocker(const PlacedShape& before, const PlacedShape& after) const;
  /// True if the shape at this pose shares area with an obstacle at a common height. False for a shape
  /// without pieces.
  bool blocked(const ObstacleShape& shape, const Pose& pose_world_body) const;
  /// The bodies whose obstacle solids overlap the shape at this pose, in ascending order of their ids, each
  /// once.
  std::vector<BodyId> overlapping(const ObstacleShape& shape, const Pose& pose_world_body) const;

 private:
  /// Data for a fast test of whether a point is inside a solid. A point is inside if the number of edges to
  /// the left of the point is odd (even-odd rule). The edges of the solid are sorted into strips parallel to
  /// the x axis, and only the edges in the strip of the point are tested. The list `covers` tells which cells
  /// of cover_grid_ are wholly inside or wholly outside the solid. Edges are counted only for points in the
  /// other cells.
  struct Strips {
    enum Cover : std::uint8_t { unknown, outside, inside };  // unknown: an edge may cross the cell

    Box box;
    Cell low;                           // cell of the corner of the box with the least x and y
    std::size_t width = 0;              // cells per row
    std::vector<Cover> covers;          // per cell, row by row; empty if there would be too many
    double y0 = 0;                      // lower border of the lowest strip, m
    double height = 1;                  // height of a strip, m
    std::vector<std::uint32_t> begins;  // per strip, and one past the end: index into edges
    std::vector<FixedEdge> edges;       // by strip; an edge is listed in every strip that it touches

    std::size_t strip_at(double y) const;  // index of the strip with this y; requires begins
  };
  /// The convex pieces of a solid as a shape in the world frame, computed at the first call. Empty if they
  /// cannot be computed. May be called by several threads.
  const ObstacleShape& pieces_of(std::size_t solid) const;
  bool deepens_in(std::size_t solid, const PlacedShape& before, const PlacedShape& after) const;
  bool inside(std::size_t solid, const Vec2& point) const;
  bool count_crossings(const Strips& strips, const Vec2& point) const;
  void sort_into_strips(std::uint32_t index, std::size_t count, Strips& strips) const;
  void cover_cells(const Solid& solid, Strips& strips, double& room) const;
  /// Whether a whole piece of the shape is inside the obstacle solids()[solid] at a common height. Requires
  /// that no edge of the obstacle enters the shape.
  bool swallows(std::size_t solid, const PlacedShape& shape) const;
  /// Calls visit(index in solids()) for each obstacle that contains a whole piece of the shape, for some
  /// obstacles more than once. Stops when a call returns true. Returns whether a call returned true.
  template <class Visit>
  bool find_swallowing(const PlacedShape& shape, Visit&& visit) const {
    return obstacle_boxes_.any_near(
        Box::around(shape.position(), shape.shape().radius),
        [&](std::uint32_t solid) { return swallows(solid, shape) && visit(solid); });
  }
  /// Calls visit(edge) for each obstacle edge that enters the shape at a common height, for some edges more
  /// than once. Stops when a call returns true. Returns whether a call returned true.
  template <class Visit>
  bool find_crossing(const PlacedShape& shape, Visit&& visit) const;

  /// The pieces of a solid, which few motions need: those of bodies that overlap it.
  struct Pieces {
    std::once_flag made;
    ObstacleShape shape;
  };

  std::vector<FixedSolid> solids_;
  std::shared_ptr<Pieces[]> pieces_;  // per solid
  std::vector<Strips> strips_;        // per solid; only the box is set if the solid is not an obstacle
  BoxGrid boxes_;                     // boxes of all solids
  // Boxes of the obstacles. An index of their own, so that tests of motions are not slowed down by many, or
  // by distant, solids that are not obstacles.
  BoxGrid obstacle_boxes_;
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
