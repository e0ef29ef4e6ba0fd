#pragma once

#include "partition/body_index.hpp"
#include "partition/sparse_grid.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace troupe::partition {

/// One edge of a static solid (a solid that does not move), world frame, metres.
struct FixedEdge {
  Vec2 a;               ///< start of the edge, world frame, metres
  Vec2 b;               ///< end of the edge, world frame, metres
  std::uint32_t solid;  ///< the solid of the edge: index into StaticScene::solids()
};

/// The outlines of the static scene (all solids that do not move), for range sensors and other sensors. The
/// outlines are divided into pieces: short chains of edges, numbered from 0. One or more circles enclose a
/// piece. A grid lists each circle in the cell of its centre. If a sensor cannot reach any circle of a piece,
/// it need not examine the edges of the piece.
///
/// The size of a piece is limited by `piece_m` (see the constructor). An edge longer than `piece_m` is a
/// piece of its own, with several circles in a row. The edge is not cut into shorter edges, because rounding
/// errors of the cuts would change sensor readings. A default-constructed object has no pieces.
class FixedOutlines {
 public:
  FixedOutlines() = default;
  /// Divides the edges into pieces.
  /// edges    the edges of each outline in order. Edges are put into one piece only if they are consecutive,
  ///          belong to the same solid, and each begins where the previous one ends
  /// piece_m  largest diagonal of the bounding box of a piece with several edges, and edge length of the
  ///          cells of the grid; metres, above 0. It affects the speed, never a reading
  FixedOutlines(std::span<const FixedEdge> edges, double piece_m);

  /// The grid that lists the circles by their centres.
  const GridGeometry& geometry() const { return geometry_; }

  /// Calls visit(span of circles) for all circles with centres in the cells from low to high, both included.
  /// Each call passes the circles of some neighbouring cells. BodyCircle::row of a circle is the number of
  /// its piece. A piece may have several circles.
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
  /// that do not touch it. BodyCircle::row of a circle is the number of its piece.
  template <class Visit>
  void for_each_run(const Box& box, Visit&& visit) const {
    const Box centres = box.expanded(largest_radius_);
    for_each_run(geometry_.cell(centres.min), geometry_.cell(centres.max), visit);
  }

  /// The vertices of the piece with this number (BodyCircle::row), world frame, metres. The edges of the
  /// piece run from each vertex to the next, and all belong to one solid. EdgeBlock::add() copies vertices in
  /// groups of k_most_edges. Therefore at least k_most_edges - 1 more vertices are readable beyond the end of
  /// the span.
  std::span<const Vec2> chain(std::uint32_t piece) const {
    return {&vertices_[pieces_[piece].first], pieces_[piece].vertices};
  }
  /// The solid of the piece with this number (BodyCircle::row), as an index into StaticScene::solids().
  std::uint32_t solid(std::uint32_t piece) const { return pieces_[piece].solid; }
  static constexpr std::uint32_t k_most_edges = 8;  ///< largest number of edges of a piece
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
