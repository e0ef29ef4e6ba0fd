#pragma once

#include "partition/parallel.hpp"
#include "partition/sparse_grid.hpp"

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe::partition {

/// A circle that encloses a body, metres, world frame: an entry of the spatial index BodyIndex. The centre is
/// the origin of the body, rounded to float. The radius is slightly larger than necessary, so that the circle
/// encloses the body in spite of rounding errors. The member `row` is the index of the body in the arrays
/// that are passed to BodyIndex::rebuild(). These arrays hold the exact position and radius.
struct BodyCircle {
  float x;            ///< x of the centre (east)
  float y;            ///< y of the centre (north)
  float radius;       ///< radius, including a margin for rounding
  std::uint32_t row;  ///< index of the body; in class FixedOutlines, number of a piece of a static outline
};

/// Returns a BodyCircle that encloses the circle with the centre `position` and this radius (m, world frame).
/// `row` is copied to the result. The radius of the result is larger than `radius`, because the centre and
/// the radius are rounded to float. The increase is about 12 micrometres at x = y = 100 m and about 12
/// millimetres at x = y = 100 km.
inline BodyCircle enclosing_circle(const Vec2& position, double radius, std::uint32_t row) {
  // Rounding a coordinate c to float moves it by at most 2^-24 |c|, or by at most 2^-150 if |c| is below the
  // smallest normal float. So the centre moves by less than `shift`. The factor 1 + 2^-22 covers the rounding
  // of the radius.
  const double shift = 0x1p-24 * (std::abs(position.x()) + std::abs(position.y())) + 0x1p-120;
  return {static_cast<float>(position.x()), static_cast<float>(position.y()),
          static_cast<float>((radius + shift) * (1 + 0x1p-22)), row};
}

/// The value in the argument `radii` of BodyIndex::rebuild() for a body that is not in the world.
inline constexpr double k_not_there = -1;

/// A spatial index of the mobile bodies, which is rebuilt in each tick (time step). The plane is divided into
/// square cells, and squares of cells form tiles (GridGeometry). The index is an array of entries, which are
/// circles that enclose the bodies (BodyCircle). The entries are sorted by cell, and within a cell by row.
/// The row of a body is its index in the arrays that are passed to rebuild(). A row with a negative radius
/// (k_not_there) is not in the index. Before the first rebuild(), the index is empty.
///
/// A body that is at most as wide as a cell has one entry, in the cell of its origin. A query for a box
/// therefore also searches the cells around the box, up to the largest radius of such bodies. A body that is
/// wider than a cell is called wide. It has an entry in each cell that the bounding square of its circle
/// touches. A single truck among small robots therefore does not enlarge the search of each query.
///
/// A wide body whose radius is larger than 32 cells is called huge, for example a robot with a long arm among
/// small robots. Entries in all cells that it touches would take too much memory. It has one entry in the
/// cell of its origin, and one in a list of all huge bodies, sorted by row. Every query visits this list.
///
/// rebuild() is a parallel counting sort in two stages. The first stage sorts the rows by tile; each task
/// counts a range of rows, so that threads share no counter. The second stage sorts the rows of each tile by
/// cell; each task sorts whole tiles. Both stages are stable, so rows in the same cell keep their order.
class BodyIndex {
 public:
  BodyIndex() = default;
  explicit BodyIndex(const GridGeometry& geometry) : geometry_(geometry) {}  ///< an empty index

  /// Reserves memory for the tiles in the box `ground` (metres, world frame), but for at most 2^14 tiles and
  /// 2^22 cells. An empty box reserves nothing. The reserved memory lets bodies enter new tiles without
  /// allocations in rebuild().
  void reserve(const Box& ground);

  /// Replaces the contents of the index. The arguments `places` and `radii` have one entry per row.
  /// places  pose of the body, metres, world frame. The position of a body in the world must not be NaN
  /// radii   radius, metres, of the circle that is centred on the origin of the body and encloses the body;
  ///         negative if the body is not in the world
  ///
  /// The caller must keep both arrays valid until the next rebuild(). for_each_near() reads them, so it must
  /// not be called after they have changed. for_each_run() reads only the entries of the index.
  ///
  /// Throws std::length_error if the tiles of the index have 2^32 or more cells in total, for example if 17
  /// million bodies are in as many tiles of 256 cells. Until the next rebuild(), the index is then unusable.
  void rebuild(std::span<const Transform> places, std::span<const double> radii, Parallel& parallel);

  /// Finds the bodies whose circles may touch the box (metres, world frame), and some other bodies. Calls
  /// visit(span of circles) once per run; a run is a sequence of consecutive entries of the index, from
  /// neighbouring cells or from the list of huge bodies. A wide body may be visited several times, in one run
  /// or in several runs. Each other body that is found is visited once.
  template <class Visit>
  void for_each_run(const Box& box, Visit&& visit) const {
    const Box reach = reach_of(box);
    for_each_run(geometry_.cell(reach.min), geometry_.cell(reach.max), visit);
  }
  /// Calls visit(span of circles) for the entries in the cells from cell_low to cell_high, both included. A
  /// body that is not wide has its only entry in the cell of its origin. If this cell is not in the range,
  /// the body is not visited, although its circle may reach into the range by at most largest_small_radius().
  /// A wide body is visited once for each cell of the range in which it has an entry. A huge body is visited
  /// in every call, and twice if the cell of its origin is in the range.
  template <class Visit>
  void for_each_run(Cell cell_low, Cell cell_high, Visit&& visit) const {
    partition::for_each_run(geometry_, directory_, cell_low, cell_high,
                            [&](std::uint32_t slot, std::size_t first, std::size_t last, Cell) {
                              const std::uint32_t* begin = &begins_[slot * geometry_.cells_per_tile()];
                              const std::uint32_t from = begin[first];
                              const std::uint32_t to = begin[last];
                              if (from < to) visit(std::span(&circles_[from], to - from));
                            });
    if (huge_ > 0) visit(huge());
  }

  /// Calls visit(circle) once for every body whose circle may touch the box (metres, world frame), and once
  /// for some bodies whose circles do not touch it. The order of the calls, and which other bodies are
  /// visited, depend on the sizes of the cells and tiles. A result must not depend on them.
  template <class Visit>
  void for_each_near(const Box& box, Visit&& visit) const {
    const Box reach = reach_of(box);
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
    if (huge_ > 0)
      for (const BodyCircle& circle : huge()) visit(circle);
  }

  /// All rows in the index, each once, sorted by the cells of the bodies' origins; valid until the next
  /// rebuild(). Rows of the same tile are adjacent. Within a tile, rows are sorted by block (a square of
  /// cells, see GridGeometry::block_bits()), then by cell, then by row. If rows are processed in this order,
  /// the data of neighbouring bodies are often still in the caches.
  std::span<const std::uint32_t> order() const { return order_; }
  /// A number that identifies the cell of the origin of the row's body. Two rows have equal numbers if and
  /// only if their origins are in the same cell. The row must be in the index. Valid until the next
  /// rebuild().
  std::uint32_t home(std::uint32_t row) const { return homes_[row]; }
  /// A number that the latest rebuild() gave to the contents of the index. No other contents, of this or of
  /// any other index of the process, have the same number. 0 before the first rebuild().
  std::uint64_t version() const { return version_; }
  /// Whether a body of this radius (m) is huge in an index with cells of this width (m).
  static bool is_huge(double radius, double cell_m) { return radius > k_huge_cells * cell_m; }
  /// Returns the largest number of entries that a body of this radius (m) can have in an index with cells of
  /// this width (m), over all positions of the body.
  static double most_entries(double radius, double cell_m) {
    if (radius <= 0.5 * cell_m) return 1;
    if (is_huge(radius, cell_m)) return 2;
    const double cells = std::floor(2 * radius / cell_m) + 2;
    return cells * cells;
  }
  /// Number of rows in the arguments of the latest rebuild(), including rows that are not in the index.
  std::size_t rows() const { return radii_.size(); }
  /// Number of tiles for which the index holds data: those that contain entries, and some that contained
  /// entries earlier.
  std::size_t tiles() const { return directory_.size(); }
  const GridGeometry& geometry() const { return geometry_; }  ///< sizes of the cells and tiles of the index
  /// The largest radius of the bodies that are not wide, metres; 0 if there are none.
  double largest_small_radius() const { return small_radius_; }
  /// Whether there are wide bodies (bodies wider than a cell), which for_each_run() may visit several times.
  bool has_wide() const { return has_wide_; }

 private:
  static constexpr double k_huge_cells = 32;  // a wide body that is not huge has at most 66 x 66 entries
  /// A margin of queries for the rounding of boxes and of distances, m. Without it, a body at a distance that
  /// is exactly the range of a sensor would be found with some sizes of the cells, and not with others. The
  /// margin is far above these errors, which are less than 1e-10 m at 100 km from the origin.
  static constexpr double k_query_margin_m = 1e-9;

  /// The box whose cells a query for `box` visits. It contains the origin of each body that is not wide and
  /// whose circle touches the box.
  Box reach_of(const Box& box) const { return box.expanded(small_radius_ + k_query_margin_m); }
  bool is_there(std::uint32_t row) const { return radii_[row] >= 0; }
  bool is_wide(std::uint32_t row) const { return radii_[row] > 0.5 * geometry_.cell_m; }
  bool is_huge(std::uint32_t row) const { return is_huge(radii_[row], geometry_.cell_m); }
  /// Whether the row is listed in every cell that its body touches, and not only in the cell of its origin.
  bool is_in_many_cells(std::uint32_t row) const { return is_wide(row) && !is_huge(row); }
  /// The entries of the huge bodies. Requires that there are any.
  std::span<const BodyCircle> huge() const { return {&circles_[begins_.back()], huge_}; }
  Cell home_cell(std::uint32_t row) const { return geometry_.cell(places_[row].position); }
  /// Returns whether for_each_near() must visit the wide body `row` at entry i of the index. A wide body has
  /// one entry in each cell that it touches, but it must be visited only once. It is visited at its entry in
  /// the lowest and leftmost cell that both the query and the body touch. False for a huge body, which is
  /// visited at its entry in the list of huge bodies.
  /// query_low    lowest and leftmost cell of the query
  /// run_cell     first cell of the run of cells that contains entry i
  /// first, last  index of the first cell of the run in its tile (GridGeometry::in_tile()), and one past the
  ///              index of the last cell
  /// begin        begin[c] is the index of the first entry of cell c of this tile
  bool first_meeting(std::uint32_t row, Cell query_low, Cell run_cell, const std::uint32_t* begin,
                     std::size_t first, std::size_t last, std::uint32_t i) const;

  /// A range of rows, from `first` to `last` - 1, that one task counts and sorts into tiles.
  struct alignas(64) Part {
    std::uint32_t first = 0;
    std::uint32_t last = 0;
    double small_radius = 0;
    bool has_wide = false;
    std::uint32_t huge = 0;  // number of the part's huge bodies
    std::vector<Cell> new_tiles;
    std::vector<std::uint32_t> next;  // per slot: number of the part's rows, then where its next row goes
  };
  void count(Part& part);
  void make_new_tiles(Parallel& parallel);
  void find_tiles(Parallel& parallel);
  void place_tiles(Parallel& parallel);
  void weigh_tile(std::size_t slot);
  void sort_tile(std::size_t slot);
  void list_huge();
  template <class Visit>
  void for_each_tile_of(std::uint32_t row, Visit&& visit) const;
  template <class Visit>
  void for_each_cell_within(std::uint32_t row, Cell tile, Visit&& visit) const;

  GridGeometry geometry_;
  TileDirectory directory_;            // gives each tile in use a number, its slot
  std::span<const Transform> places_;  // owned by the caller
  std::span<const double> radii_;      // owned by the caller
  std::uint64_t version_ = 0;
  double small_radius_ = 0;  // largest radius of the bodies that are not wide
  bool has_wide_ = false;
  std::uint32_t huge_ = 0;    // number of huge bodies
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
  std::vector<BodyCircle> circles_;    // by tile and cell, and then the list of huge bodies
  std::vector<std::uint32_t> order_;
};

}  // namespace troupe::partition
