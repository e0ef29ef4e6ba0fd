#pragma once

#include "partition/body_index.hpp"
#include "partition/sparse_grid.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace troupe::partition {

/// One edge of a static solid, world frame, metres.
struct FixedEdge {
  Vec2 a;               ///< start of the edge, world frame, metres
  Vec2 b;               ///< end of the edge, world frame, metres
  std::uint32_t solid;  ///< the solid of the edge: index into StaticScene::solids()
};

/// The outlines of the static scene (all solids that do not move), for rangers (range sensors) and other
/// sensors. The outlines are divided into pieces: short chains of edges, each with an enclosing circle. A
/// grid indexes the circles by the cells of their centres. A ranger skips a piece if its beams cannot reach
/// the circle of the piece, as it does for bodies. An edge longer than `piece_m` (see the constructor) is a
/// piece of its own, which several circles together enclose. The edge is not cut, because cutting would
/// change the bits of readings. A default-constructed object has no pieces.
class FixedOutlines {
 public:
  FixedOutlines() = default;
  /// edges: in the order of the outlines; only consecutive edges that share an end are joined to a piece.
  /// piece_m: side of the cells of the grid, and largest diagonal of the bounding box of a piece that has
  /// several edges, metres, above 0. piece_m affects the speed, never a reading.
  FixedOutlines(std::span<const FixedEdge> edges, double piece_m);

  /// The grid of the circles' centres.
  const GridGeometry& geometry() const { return geometry_; }

  /// Calls visit(span of circles) for all circles with centres in the cells from low to high, both included.
  /// Each call passes the circles of the cells of one row within one tile (a square of cells, see
  /// GridGeometry). The member `row` of a circle is the number of its piece. A piece may have several
  /// circles.
  template <class Visit>
  void for_each_run(Cell low, Cell high, Visit&& visit) const {
    partition::for_each_run(geometry_, directory_, low, high,
                            [&](std::uint32_t slot, std::size_t first, std::size_t last, Cell) {
                              const std::uint32_t* begin = &begins_[slot * geometry_.cells_per_tile()];
                              if (begin[first] < begin[last])
                                visit(std::span(&circles_[begin[first]], begin[last] - begin[first]));
                            });
  }

  /// Calls visit(span of circles) for the circles that may touch the box (world frame, metres), and for some
  /// that do not touch it.
  template <class Visit>
  void for_each_run(const Box& box, Visit&& visit) const {
    const Box centres = box.expanded(largest_radius_);
    for_each_run(geometry_.cell(centres.min), geometry_.cell(centres.max), visit);
  }

  /// The vertices of a piece, world frame, metres. The edges of the piece run from each vertex to the next,
  /// and all belong to one solid. At least k_most_edges - 1 more vertices are readable beyond the end,
  /// because EdgeBlock::add() copies k_most_edges vertices at a time. piece: its number (BodyCircle::row).
  std::span<const Vec2> chain(std::uint32_t piece) const {
    return {&vertices_[pieces_[piece].first], pieces_[piece].vertices};
  }
  /// The solid of a piece: index into StaticScene::solids(). piece: its number (BodyCircle::row).
  std::uint32_t solid(std::uint32_t piece) const { return pieces_[piece].solid; }
  static constexpr std::uint32_t k_most_edges = 8;  ///< most edges of a piece
  /// The largest radius of the circles, metres; 0 if there are none.
  double largest_radius() const { return largest_radius_; }

 private:
  struct Piece {
    std::uint32_t first;
    std::uint32_t vertices;
    std::uint32_t solid;
  };

  GridGeometry geometry_;
  TileDirectory directory_;  // gives each tile in use a number, its slot
  double largest_radius_ = 0;
  std::vector<std::uint32_t> begins_;  // per slot and cell, and one past the end: index into circles_
  std::vector<BodyCircle> circles_;
  std::vector<Piece> pieces_;
  std::vector<Vec2> vertices_;
};

}  // namespace troupe::partition
