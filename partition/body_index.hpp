#pragma once

#include "partition/parallel.hpp"
#include "partition/sparse_grid.hpp"

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe::partition {

/// Where a body is, for queries: a circle, in metres and the world's frame, that certainly contains the one
/// about the body's origin that encloses it. Floats, so that four entries fill a cache line and kernels can
/// load them as they are: code that needs the place itself finds it by the row.
struct BodyCircle {
  float x;            ///< of its centre, east
  float y;            ///< of its centre, north
  float radius;       ///< negative: nothing is there; queries give no such circle
  std::uint32_t row;  ///< whose it is, or which piece
};

/// Rounding moves a coordinate c by at most 2^-24 |c| (2^-150 below the normal numbers), and the centre by no
/// more than both coordinates together; the radius grows by that, and a step of 2^-22 is left for the
/// rounding of the radius itself. At 100 m from the origin that is 12 micrometres, at 100 km 12 millimetres.
inline BodyCircle enclosing_circle(const Vec2& position, double radius, std::uint32_t row) {
  const double shift = 0x1p-24 * (std::abs(position.x()) + std::abs(position.y())) + 0x1p-120;
  return {static_cast<float>(position.x()), static_cast<float>(position.y()),
          static_cast<float>((radius + shift) * (1 + 0x1p-22)), row};
}

/// The radius of a body that is not there.
inline constexpr double k_not_there = -1;

/// The bodies that move, by the cell they are in: contiguous, in (cell, row) order, rebuilt in parallel each
/// tick by a counting sort: first by tile, then, a tile each task, by cell. Both are stable, so that no rows
/// need comparing, and no counter is shared between threads.
///
/// A body not wider than a cell lies in the cell of its origin alone, and queries reach out by the largest
/// such radius. A wider one lies in every cell it touches, and a query gives it once, so that one truck does
/// not widen every query.
///
/// A row of which the radius is negative (k_not_there) is not in the index: no query gives it.
class BodyIndex {
 public:
  BodyIndex() = default;
  explicit BodyIndex(const GridGeometry& geometry) : geometry_(geometry) {}  ///< of no bodies

  /// Makes room for bodies all over this ground, within reason: rebuild() allocates where there are more rows
  /// than ever before, and where bodies enter ground that no room was made for.
  void reserve(const Box& ground);

  /// places and radii: one a row, m. The index looks at both again when it is queried, and keeps nothing
  /// of its previous contents.
  void rebuild(std::span<const Transform> places, std::span<const double> radii, Parallel& parallel);

  /// visit(span of circles) for the runs of cells, row of cells by row of cells, that hold every body whose
  /// circle may touch the box, and some that do not. A wide body may come more than once, in one run and in
  /// several; others come once.
  template <class Visit>
  void for_each_run(const Box& box, Visit&& visit) const {
    const Box reach = box.expanded(small_radius_);
    for_each_run(geometry_.cell(reach.min), geometry_.cell(reach.max), visit);
  }
  /// The same for the cells from low to high: all that lie in them, but of those whose circle only reaches
  /// in none. Bodies that are not wide reach largest_small_radius() beyond the cell of their origin at most.
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

  /// visit(circle) for every body whose circle may touch the box, each once, and some that do not.
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

  /// Every row that is there once, in (tile, block, cell, row) order: the order in which to work so that
  /// neighbours share caches.
  std::span<const std::uint32_t> order() const { return order_; }
  /// A number for the cell that holds the row's origin: rows that follow one another in order() share the
  /// cell where it is equal. Until the next rebuild.
  std::uint32_t home(std::uint32_t row) const { return homes_[row]; }
  /// That it knows: those with bodies in them, and some that had lately.
  std::size_t tiles() const { return directory_.size(); }
  const GridGeometry& geometry() const { return geometry_; }  ///< how the plane is cut
  /// The largest radius of the bodies that lie in one cell alone, m.
  double largest_small_radius() const { return small_radius_; }
  /// Whether some bodies lie in several cells, and so may come more than once in runs.
  bool has_wide() const { return has_wide_; }

 private:
  bool is_there(std::uint32_t row) const { return radii_[row] >= 0; }
  bool is_wide(std::uint32_t row) const { return radii_[row] > 0.5 * geometry_.cell_m; }
  Cell home_cell(std::uint32_t row) const { return geometry_.cell(places_[row].position); }
  /// Of a wide body's entries within the query, the one at the lowest cell counts.
  bool first_meeting(std::uint32_t row, Cell query_low, Cell run_cell, const std::uint32_t* begin,
                     std::size_t first, std::size_t last, std::uint32_t i) const;

  /// A part of the rows, counted and handed out by one task.
  struct alignas(64) Part {
    std::uint32_t first = 0;
    std::uint32_t last = 0;
    double small_radius = 0;
    bool has_wide = false;
    std::vector<Cell> new_tiles;
    std::vector<std::uint32_t> next;  // per slot: how many of the part, then where the next one goes
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
  std::span<const Transform> places_;  // the caller's
  std::span<const double> radii_;      // the caller's
  double small_radius_ = 0;            // largest radius among those that lie in one cell
  bool has_wide_ = false;              // some lie in more
  std::size_t reserved_ = 0;           // tiles
  std::vector<Part> parts_;
  struct Tile {
    std::uint32_t rows = 0;     // that touch it: in tile_rows_
    std::uint32_t circles = 0;  // in circles_
    std::uint32_t homes = 0;    // rows whose origin it holds: in order_
    Tile& operator+=(const Tile& other) {
      rows += other.rows;
      circles += other.circles;
      homes += other.homes;
      return *this;
    }
  };
  std::vector<Tile> counts_;  // per slot
  std::vector<Tile> tiles_;   // per slot, one closing entry: where it starts
  std::vector<Tile> sums_;
  std::vector<BodyCircle> tile_rows_;  // by tile
  std::vector<std::uint32_t> begins_;  // per slot and cell, one closing entry: into circles_
  std::vector<std::uint32_t> homes_;   // per row: slot * cells + cell of its origin
  std::vector<BodyCircle> circles_;    // by tile and cell
  std::vector<std::uint32_t> order_;
};

}  // namespace troupe::partition
