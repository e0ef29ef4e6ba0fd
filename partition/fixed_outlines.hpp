#pragma once

#include "partition/body_index.hpp"
#include "partition/sparse_grid.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace troupe::partition {

/// One edge of a fixed solid, world frame, metres.
struct FixedEdge {
  Vec2 a;               ///< from
  Vec2 b;               ///< to
  std::uint32_t solid;  ///< index into StaticScene::solids()
};

/// The outlines of the static scene, for rangers: cut into short chains of a few edges, each with a circle
/// that encloses it, and the circles by the cell of their centre. To a ranger a piece is like a body: a
/// circle that it may leave out, and edges. An edge longer than a piece has several circles, and is never
/// cut itself: that would change bits.
class FixedOutlines {
 public:
  FixedOutlines() = default;
  /// edges: those of one outline one after another. Pieces are no wider than piece_m; how wide never changes
  /// a reading.
  FixedOutlines(std::span<const FixedEdge> edges, double piece_m);

  /// How the plane is cut for the pieces' centres.
  const GridGeometry& geometry() const { return geometry_; }

  /// visit(span of circles) for the runs of cells from low to high; a circle's row is the number of its
  /// piece.
  template <class Visit>
  void for_each_run(Cell low, Cell high, Visit&& visit) const {
    partition::for_each_run(geometry_, directory_, low, high,
                            [&](std::uint32_t slot, std::size_t first, std::size_t last, Cell) {
                              const std::uint32_t* begin = &begins_[slot * geometry_.cells_per_tile()];
                              if (begin[first] < begin[last])
                                visit(std::span(&circles_[begin[first]], begin[last] - begin[first]));
                            });
  }

  /// The edges of a piece, all of one solid: from each vertex to the next.
  std::span<const Vec2> chain(std::uint32_t piece) const {
    return {&vertices_[pieces_[piece].first], pieces_[piece].vertices};
  }
  /// Of a piece: index into StaticScene::solids().
  std::uint32_t solid(std::uint32_t piece) const { return pieces_[piece].solid; }
  static constexpr std::uint32_t k_most_edges = 8;  ///< of a piece
  /// No circle reaches farther than this beyond the cell of its centre, m.
  double largest_radius() const { return largest_radius_; }

 private:
  struct Piece {
    std::uint32_t first;
    std::uint32_t vertices;
    std::uint32_t solid;
  };

  GridGeometry geometry_;
  TileDirectory directory_;
  double largest_radius_ = 0;
  std::vector<std::uint32_t> begins_;  // per slot and cell, one closing entry: into circles_
  std::vector<BodyCircle> circles_;
  std::vector<Piece> pieces_;
  std::vector<Vec2> vertices_;
};

}  // namespace troupe::partition
