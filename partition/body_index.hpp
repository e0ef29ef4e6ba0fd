#pragma once

#include "partition/parallel.hpp"
#include "partition/sparse_grid.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace troupe::partition {

/// Where a body is, for queries.
struct BodyEntry {
  Vec2 position;  ///< of the body's origin, m
  double radius;  ///< of the circle about the origin that encloses it, m
  std::uint32_t row;
};

/// The bodies that move, by the cell they are in: contiguous, in (cell, row) order, rebuilt in parallel each
/// tick by a counting sort over the tiles in use.
///
/// A body not wider than a cell lies in the cell of its origin alone, and queries reach out by the largest
/// such radius. A wider one lies in every cell it touches, and a query gives it once, so that one truck does
/// not widen every query.
class BodyIndex {
 public:
  BodyIndex() = default;
  explicit BodyIndex(const GridGeometry& geometry) : geometry_(geometry) {}

  /// positions and radii: one a row. Nothing of the previous contents is kept.
  void rebuild(std::span<const Vec2> positions, std::span<const double> radii, Parallel& parallel);

  /// visit(entry) for every body whose circle may touch the box, each once, and some that do not.
  template <class Visit>
  void for_each_near(const Box& box, Visit&& visit) const {
    const Box reach = box.expanded(small_radius_);
    const Cell low = geometry_.cell(reach.min);
    for_each_run(
        geometry_, directory_, reach,
        [&](std::uint32_t slot, std::size_t first, std::size_t last, Cell first_cell) {
          const std::uint32_t* begin = &begins_[slot * geometry_.cells_per_tile()];
          for (std::uint32_t i = begin[first]; i < begin[last]; ++i) {
            const BodyEntry& entry = entries_[i];
            if (entry.radius > small_limit() && !first_meeting(entry, low, first_cell, begin, first, last, i))
              continue;
            visit(entry);
          }
        });
  }

  /// Every row once, rows of one tile together: the order in which to work so that neighbours share caches.
  std::span<const std::uint32_t> order() const { return order_; }
  std::size_t tiles() const { return directory_.size(); }

 private:
  double small_limit() const { return 0.5 * geometry_.cell_m; }
  /// Of a wide body's entries within the query, the one at the lowest cell counts.
  bool first_meeting(const BodyEntry& entry, Cell query_low, Cell run_cell, const std::uint32_t* begin,
                     std::size_t first, std::size_t last, std::uint32_t i) const;

  GridGeometry geometry_;
  TileDirectory directory_;
  double small_radius_ = 0;            // largest radius among those that lie in one cell
  std::vector<std::uint32_t> begins_;  // per slot and cell, one closing entry: into entries_
  std::vector<std::uint32_t> next_;    // counters of the sort
  std::vector<std::uint32_t> tile_rows_;
  std::vector<std::uint32_t> homes_;  // first place of each slot in order_
  std::vector<BodyEntry> entries_;
  std::vector<std::uint32_t> order_;
};

}  // namespace troupe::partition
