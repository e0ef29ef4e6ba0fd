#pragma once

#include "partition/parallel.hpp"
#include "partition/sparse_grid.hpp"

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe::partition {

/// A circle that encloses a body, metres, world frame, for queries. It contains the body's own circle (about
/// the body's origin) in spite of rounding to float. Floats, so that four entries fill a cache line and
/// kernels load them directly; the exact position is found by the row.
struct BodyCircle {
  float x;            ///< centre, east
  float y;            ///< centre, north
  float radius;       ///< negative: absent; queries return no such circle
  std::uint32_t row;  ///< row of the body, or number of the piece
};

/// The circle about a position, enlarged for rounding. Rounding moves a coordinate c by at most 2^-24 |c|
/// (2^-150 below the normal numbers), and the centre by at most the sum of both. The radius grows by that
/// sum, and by a factor of 1 + 2^-22 for its own rounding: 12 micrometres at 100 m from the origin, 12
/// millimetres at 100 km.
inline BodyCircle enclosing_circle(const Vec2& position, double radius, std::uint32_t row) {
  const double shift = 0x1p-24 * (std::abs(position.x()) + std::abs(position.y())) + 0x1p-120;
  return {static_cast<float>(position.x()), static_cast<float>(position.y()),
          static_cast<float>((radius + shift) * (1 + 0x1p-22)), row};
}

/// The radius of an absent body.
inline constexpr double k_not_there = -1;

/// An index of the mobile bodies by grid cell: contiguous, in (cell, row) order. Each tick a parallel
/// counting sort rebuilds it: first by tile, then by cell with one task per tile. Both sorts are stable, so
/// that rows need not be compared and threads share no counter.
///
/// A body not wider than a cell is in the cell of its origin only, and queries are expanded by the largest
/// such radius. A wider body is in every cell that it touches, so that one truck does not expand every query.
///
/// A row with a negative radius (k_not_there) is not in the index.
class BodyIndex {
 public:
  BodyIndex() = default;
  explicit BodyIndex(const GridGeometry& geometry) : geometry_(geometry) {}  ///< an empty index

  /// Reserves memory for bodies anywhere on this ground, for up to 2^14 tiles. Afterwards rebuild() allocates
  /// only if there are more rows than ever before, or if bodies enter other tiles.
  void reserve(const Box& ground);

  /// Replaces the contents. places, radii: one entry per row, metres, world frame. Queries read both, so they
  /// must stay valid and unchanged until the next rebuild().
  void rebuild(std::span<const Transform> places, std::span<const double> radii, Parallel& parallel);

  /// Calls visit(span of circles) for runs of cells. The runs contain every body whose circle may touch the
  /// box, and some that do not touch it. A wide body may come more than once, in one run or in several;
  /// others come once.
  template <class Visit>
  void for_each_run(const Box& box, Visit&& visit) const {
    const Box reach = box.expanded(small_radius_);
    for_each_run(geometry_.cell(reach.min), geometry_.cell(reach.max), visit);
  }
  /// Calls visit(span of circles) for the bodies in the cells from low to high, both included. Bodies that
  /// only reach into these cells are omitted: a body that is not wide reaches at most largest_small_radius()
  /// beyond the cell of its origin.
  template <class Visit>
  void for_each_run(Cell cell_low, Cell cell_high, Visit&& visit) const {
    partition::for_each_run(geometry_, directory_, cell_low, cell_high,
                            [&](std::uint32_t slot, std::size_t first, std::size_t last, Cell) {
                              const std::uint32_t* begin = &begins_[slot * geometry_.cells_per_tile()];
                              const std::uint32_t from = begin[first];
                              const std::uint32_t to = begin[last];
                              if (from < to) visit(std::span(&circles_[from], to - from));
                            });
  }

  /// Calls visit(circle) once for every body whose circle may touch the box, and for some that do not touch
  /// it.
  template <class Visit>
  void for_each_near(const Box& box, Visit&& visit) const {
    const Box reach = box.expanded(small_radius_);
    const Cell low = geometry_.cell(reach.min);
    partition::for_each_run(geometry_, directory_, reach,
                            [&](std::uint32_t slot, std::size_t first, std::size_t last, Cell first_cell) {
                              const std::uint32_t* begin = &begins_[slot * geometry_.cells_per_tile()];
                              for (std::uint32_t i = begin[first]; i < begin[last]; ++i) {
                                const BodyCircle& circle = circles_[i];
                                if (has_wide_ && is_wide(circle.row) &&
                                    !first_meeting(circle.row, low, first_cell, begin, first, last, i))
                                  continue;
                                visit(circle);
                              }
                            });
  }

  /// All rows in the index, each once, in (tile, block, cell, row) order. Work in this order keeps neighbours
  /// in the caches.
  std::span<const std::uint32_t> order() const { return order_; }
  /// A number that identifies the cell of the row's origin: equal for rows in one cell. Valid until the next
  /// rebuild().
  std::uint32_t home(std::uint32_t row) const { return homes_[row]; }
  /// Number of known tiles: those that contain bodies, and some that recently did.
  std::size_t tiles() const { return directory_.size(); }
  const GridGeometry& geometry() const { return geometry_; }  ///< the grid
  /// The largest radius of the bodies that are not wide, metres.
  double largest_small_radius() const { return small_radius_; }
  /// Whether there are wide bodies, which may come more than once in runs.
  bool has_wide() const { return has_wide_; }

 private:
  bool is_there(std::uint32_t row) const { return radii_[row] >= 0; }
  bool is_wide(std::uint32_t row) const { return radii_[row] > 0.5 * geometry_.cell_m; }
  Cell home_cell(std::uint32_t row) const { return geometry_.cell(places_[row].position); }
  /// Whether entry i of a wide body is the one in the body's lowest cell within the query: only that one
  /// counts.
  bool first_meeting(std::uint32_t row, Cell query_low, Cell run_cell, const std::uint32_t* begin,
                     std::size_t first, std::size_t last, std::uint32_t i) const;

  /// A part of the rows, counted and distributed by one task.
  struct alignas(64) Part {
    std::uint32_t first = 0;
    std::uint32_t last = 0;
    double small_radius = 0;
    bool has_wide = false;
    std::vector<Cell> new_tiles;
    std::vector<std::uint32_t> next;  // per slot: the number of the part's rows, then where the next one goes
  };
  void count(Part& part);
  void make_new_tiles(Parallel& parallel);
  void place_tiles(Parallel& parallel);
  void weigh_tile(std::size_t slot);
  void sort_tile(std::size_t slot);
  template <class Visit>
  void for_each_tile_of(std::uint32_t row, Visit&& visit) const;
  template <class Visit>
  void for_each_cell_within(std::uint32_t row, Cell tile, Visit&& visit) const;

  GridGeometry geometry_;
  TileDirectory directory_;
  std::span<const Transform> places_;  // owned by the caller
  std::span<const double> radii_;      // owned by the caller
  double small_radius_ = 0;            // largest radius of the bodies that are not wide
  bool has_wide_ = false;
  std::size_t reserved_ = 0;  // tiles
  std::vector<Part> parts_;
  struct Tile {
    std::uint32_t rows = 0;     // rows that touch it, in tile_rows_
    std::uint32_t circles = 0;  // entries in circles_
    std::uint32_t homes = 0;    // rows whose origin is in it, in order_
    Tile& operator+=(const Tile& other) {
      rows += other.rows;
      circles += other.circles;
      homes += other.homes;
      return *this;
    }
  };
  std::vector<Tile> counts_;  // per slot
  std::vector<Tile> tiles_;   // per slot, and one past the end: where it starts
  std::vector<Tile> sums_;
  std::vector<BodyCircle> tile_rows_;  // by tile
  std::vector<std::uint32_t> begins_;  // per slot and cell, and one past the end: index into circles_
  std::vector<std::uint32_t> homes_;   // per row: slot * cells + cell of its origin
  std::vector<BodyCircle> circles_;    // by tile and cell
  std::vector<std::uint32_t> order_;
};

}  // namespace troupe::partition
