#pragma once

#include "partition/parallel.hpp"
#include "partition/sparse_grid.hpp"

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe::partition {

/// A circle that encloses a body, metres, world frame: an entry of a spatial index. Its coordinates and
/// radius are floats, so that four circles fill a cache line and SIMD kernels load them directly. To cover
/// the rounding to float, the circle is slightly larger than the exact one, which is centred on the body's
/// origin. The member `row` is the index of the body in the arrays passed to BodyIndex::rebuild(), which hold
/// its exact position.
struct BodyCircle {
  float x;            ///< x of the centre (east)
  float y;            ///< y of the centre (north)
  float radius;       ///< slightly more than the exact radius
  std::uint32_t row;  ///< row of the body; in class FixedOutlines, the number of a piece of a static outline
};

/// Makes a BodyCircle that encloses the circle with this radius about this position (m, world frame). `row`
/// is stored in the result. Rounding a coordinate c to float moves it by at most 2^-24 |c|, or by at most
/// 2^-150 if |c| is below the smallest normal float. Rounding therefore moves the centre by at most 2^-24
/// (|x| + |y|) + 2^-149. The radius is increased by slightly more than this distance, and then multiplied by
/// 1 + 2^-22 because the radius is rounded to float, too. The increase is 12 micrometres at x = y = 100 m and
/// 12 millimetres at x = y = 100 km.
inline BodyCircle enclosing_circle(const Vec2& position, double radius, std::uint32_t row) {
  const double shift = 0x1p-24 * (std::abs(position.x()) + std::abs(position.y())) + 0x1p-120;
  return {static_cast<float>(position.x()), static_cast<float>(position.y()),
          static_cast<float>((radius + shift) * (1 + 0x1p-22)), row};
}

/// The value in the argument `radii` of BodyIndex::rebuild() for a body that is not in the world.
inline constexpr double k_not_there = -1;

/// A spatial index of the mobile bodies: their circles in one array, sorted by grid cell, and within a cell
/// by row (the index of the body in the arguments of rebuild()). A parallel counting sort rebuilds the index
/// in each tick (time step). It sorts the rows by tile (a square of cells, see GridGeometry), and then the
/// rows of each tile by cell. In the first sort, each task counts a range of rows of its own, so that threads
/// share no counter; in the second, each task sorts whole tiles. Both sorts are stable: they keep the order
/// of the rows without comparing them.
///
/// A body not wider than a cell is listed only in the cell of its origin. The box of a query is therefore
/// expanded by the largest radius of such bodies. A wider body, called a wide body below, is listed in every
/// cell that the bounding square of its circle touches, so that one truck does not expand every query.
///
/// A row with a negative radius (k_not_there) is not in the index. Before the first rebuild(), the index is
/// empty.
class BodyIndex {
 public:
  BodyIndex() = default;
  explicit BodyIndex(const GridGeometry& geometry) : geometry_(geometry) {}  ///< an empty index

  /// Reserves memory for bodies anywhere in the box `ground` (metres, world frame), but for at most 2^14
  /// tiles. An empty box reserves nothing. Afterwards rebuild() allocates only if there are more rows than in
  /// any earlier call, or if bodies are in more tiles than were reserved.
  void reserve(const Box& ground);

  /// Replaces the contents. places and radii have one entry per row. places: the pose of the body (metres,
  /// world frame). radii: the radius (metres) of the circle that is centred on the body's origin and encloses
  /// the body; negative if the body is not in the world. The position of a body in the world must not be NaN.
  /// Queries read both arrays, so the caller must keep them valid and unchanged until the next rebuild().
  void rebuild(std::span<const Transform> places, std::span<const double> radii, Parallel& parallel);

  /// Calls visit(span of circles) once per run. A run is a sequence of consecutive entries of the index, from
  /// neighbouring cells. Together the runs contain every body whose circle may touch the box (metres, world
  /// frame), and some that do not touch it. A wide body may be visited several times, in one run or in
  /// several; every other body is visited once.
  template <class Visit>
  void for_each_run(const Box& box, Visit&& visit) const {
    const Box reach = box.expanded(small_radius_);
    for_each_run(geometry_.cell(reach.min), geometry_.cell(reach.max), visit);
  }
  /// Calls visit(span of circles) for the bodies in the cells from cell_low to cell_high, both included. A
  /// body that is not wide belongs only to the cell of its origin. It is omitted if this cell is outside the
  /// range, although its circle may reach into the range, by at most largest_small_radius().
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

  /// Calls visit(circle) once for every body whose circle may touch the box (metres, world frame), and once
  /// for some bodies whose circles do not touch it.
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

  /// All rows in the index, each once; valid until the next rebuild(). Rows whose bodies have their origins
  /// in the same tile are adjacent. Within a tile, rows are sorted by block (a square of cells, see
  /// GridGeometry::block_bits()), then by cell, then by row. If rows are processed in this order, the data of
  /// their neighbours are often still in the caches.
  std::span<const std::uint32_t> order() const { return order_; }
  /// A number that identifies the cell of the origin of the row's body: two rows have equal numbers if and
  /// only if their origins are in one cell. The row must be in the index. Valid until the next rebuild().
  std::uint32_t home(std::uint32_t row) const { return homes_[row]; }
  /// Number of rows that the latest rebuild() received, in the index or not.
  std::size_t rows() const { return radii_.size(); }
  /// Number of known tiles: those in which bodies are listed, and some in which bodies were listed earlier.
  std::size_t tiles() const { return directory_.size(); }
  const GridGeometry& geometry() const { return geometry_; }  ///< sizes of the cells and tiles of the index
  /// The largest radius of the bodies that are not wide (not wider than a cell), metres; 0 if there are none.
  double largest_small_radius() const { return small_radius_; }
  /// Whether there are wide bodies, which for_each_run() may visit several times.
  bool has_wide() const { return has_wide_; }

 private:
  bool is_there(std::uint32_t row) const { return radii_[row] >= 0; }
  bool is_wide(std::uint32_t row) const { return radii_[row] > 0.5 * geometry_.cell_m; }
  Cell home_cell(std::uint32_t row) const { return geometry_.cell(places_[row].position); }
  /// Returns whether for_each_near() must visit a wide body at its entry i. A wide body has one entry in each
  /// cell that it touches. Only one of them counts, so that the body is visited once: the entry in the lower
  /// left of those cells that are within the query.
  bool first_meeting(std::uint32_t row, Cell query_low, Cell run_cell, const std::uint32_t* begin,
                     std::size_t first, std::size_t last, std::uint32_t i) const;

  /// A range of rows, [first, last), that one task counts and sorts into tiles.
  struct alignas(64) Part {
    std::uint32_t first = 0;
    std::uint32_t last = 0;
    double small_radius = 0;
    bool has_wide = false;
    std::vector<Cell> new_tiles;
    std::vector<std::uint32_t> next;  // per slot: number of the part's rows, then where its next row goes
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
  TileDirectory directory_;            // gives each tile in use a number, its slot
  std::span<const Transform> places_;  // owned by the caller
  std::span<const double> radii_;      // owned by the caller
  double small_radius_ = 0;            // largest radius of the bodies that are not wide
  bool has_wide_ = false;
  std::size_t reserved_ = 0;  // tiles
  std::vector<Part> parts_;
  struct Tile {
    std::uint32_t rows = 0;     // rows of bodies that touch the tile, in tile_rows_
    std::uint32_t circles = 0;  // entries in circles_
    std::uint32_t homes = 0;    // rows of bodies whose origin is in the tile, in order_
    Tile& operator+=(const Tile& other) {
      rows += other.rows;
      circles += other.circles;
      homes += other.homes;
      return *this;
    }
  };
  std::vector<Tile> counts_;  // per slot
  std::vector<Tile> tiles_;   // per slot, and one past the end: where the tile starts in each array
  std::vector<Tile> sums_;
  std::vector<BodyCircle> tile_rows_;  // by tile
  std::vector<std::uint32_t> begins_;  // per slot and cell, and one past the end: index into circles_
  std::vector<std::uint32_t> homes_;   // per row: slot of its origin's tile * cells per tile + cell in it
  std::vector<BodyCircle> circles_;    // by tile and cell
  std::vector<std::uint32_t> order_;
};

}  // namespace troupe::partition
