#pragma once

#include "base/assert.hpp"
#include "base/geometry.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace troupe::partition {

/// A square in a grid on the plane, given by its column and its row. Cell (0, 0) has its lower left corner at
/// the origin of the world frame. The struct also stands for blocks and tiles, which are larger squares (see
/// GridGeometry). Block (0, 0) and tile (0, 0) have the same corner.
struct Cell {
  std::int32_t x = 0;  ///< column; increases with x
  std::int32_t y = 0;  ///< row; increases with y
  friend bool operator==(Cell, Cell) = default;
};

/// A grid of square cells on the plane. Squares of cells form blocks, and squares of blocks form tiles.
struct GridGeometry {
  double cell_m = 1;       ///< edge of a cell, metres
  unsigned tile_bits = 3;  ///< a tile is 2^tile_bits cells wide

  std::size_t cells_per_tile() const { return std::size_t{1} << (2 * tile_bits); }  ///< cells per tile
  double tile_m() const { return cell_m * static_cast<double>(1u << tile_bits); }  ///< edge of a tile, metres

  /// The cell that contains a point (metres, world frame). Coordinates must not be NaN. Coordinates beyond
  /// +-2^30 cells are clamped to +-2^30 cells.
  Cell cell(const Vec2& p) const { return {index(p.x()), index(p.y())}; }
  /// The tile that contains a cell.
  Cell tile(Cell c) const { return {c.x >> tile_bits, c.y >> tile_bits}; }
  /// The binary logarithm of the width of a block in cells. A block is 4 cells wide, or as wide as a tile if
  /// a tile is narrower than 4 cells. Bodies in one block are processed together and share the search for
  /// their neighbours.
  unsigned block_bits() const { return tile_bits < 2 ? tile_bits : 2; }
  Cell block(Cell c) const { return {c.x >> block_bits(), c.y >> block_bits()}; }  ///< the block of a cell
  /// The bounds of a block, metres, world frame.
  Box box_of_block(Cell block) const {
    const double edge = cell_m * static_cast<double>(1u << block_bits());
    Box box;
    box.min = Vec2(block.x * edge, block.y * edge);
    box.max = Vec2((block.x + 1.0) * edge, (block.y + 1.0) * edge);
    return box;
  }
  /// The index of a cell in its tile, from 0 to cells_per_tile() - 1. Cells are numbered row by row, so that
  /// neighbouring cells along x have consecutive indices.
  std::size_t in_tile(Cell c) const {
    const std::int32_t mask = (1 << tile_bits) - 1;
    return (static_cast<std::size_t>(c.y & mask) << tile_bits) | static_cast<std::size_t>(c.x & mask);
  }

 private:
  std::int32_t index(double v) const {
    constexpr double k_limit = 1 << 30;
    double c = v / cell_m;
    if (c > k_limit) c = k_limit;
    if (c < -k_limit) c = -k_limit;
    const auto i = static_cast<std::int32_t>(c);
    return static_cast<double>(i) > c ? i - 1 : i;
  }
};

/// A hash table (open addressing) that numbers tiles. The number of a tile is called its slot. The first tile
/// that is passed to insert() gets slot 0, the next new tile slot 1, and so on. Tiles that were not passed to
/// insert() take no memory.
class TileDirectory {
 public:
  static constexpr std::uint32_t k_none = ~0u;  ///< result of find() for a tile without a slot

  TileDirectory() : keys_(16), slots_(16, k_none) {}  ///< an empty directory
  /// Removes all tiles; slots start at 0 again.
  void clear() {
    std::ranges::fill(slots_, k_none);
    tiles_.clear();
  }
  /// Reserves memory for this many tiles.
  void reserve(std::size_t tiles) {
    while (tiles * 2 > keys_.size()) grow();
    tiles_.reserve(tiles);
  }
  std::size_t size() const { return tiles_.size(); }  ///< number of tiles; slots are 0 to size() - 1
  Cell tile(std::uint32_t slot) const { return tiles_[slot]; }  ///< the tile of a slot below size()

  /// The slot of a tile; k_none if the tile has no slot.
  std::uint32_t find(Cell tile) const {
    for (std::size_t i = start(tile);; i = (i + 1) & (keys_.size() - 1)) {
      if (slots_[i] == k_none) return k_none;
      if (keys_[i] == tile) return slots_[i];
    }
  }

  /// Returns the slot of a tile. A tile without a slot gets the next free slot.
  std::uint32_t insert(Cell tile) {
    if ((tiles_.size() + 1) * 2 > keys_.size()) grow();
    std::size_t i = start(tile);
    for (; slots_[i] != k_none; i = (i + 1) & (keys_.size() - 1))
      if (keys_[i] == tile) return slots_[i];
    keys_[i] = tile;
    slots_[i] = static_cast<std::uint32_t>(tiles_.size());
    tiles_.push_back(tile);
    return slots_[i];
  }

 private:
  std::size_t start(Cell t) const {
    const std::uint64_t key =
        (static_cast<std::uint64_t>(static_cast<std::uint32_t>(t.x)) << 32) | static_cast<std::uint32_t>(t.y);
    return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ull) >> 32) & (keys_.size() - 1);
  }
  void grow() {
    const std::vector<Cell> tiles = tiles_;
    keys_.assign(keys_.size() * 2, {});
    slots_.assign(slots_.size() * 2, k_none);
    tiles_.clear();
    for (const Cell t : tiles) insert(t);
  }

  std::vector<Cell> keys_;
  std::vector<std::uint32_t> slots_;
  std::vector<Cell> tiles_;
};

/// Visits those cells of the rectangle from low to high, both included, whose tiles are in the directory. The
/// cells are visited in runs: a run is the part of a row of cells that is in one tile. For each run, calls
/// visit(slot, first, last, cell).
/// slot   slot of the tile
/// first  index of the first cell of the run in the tile (GridGeometry::in_tile())
/// last   one past the index of the last cell of the run in the tile
/// cell   the first cell of the run
template <class Visit>
void for_each_run(const GridGeometry& grid, const TileDirectory& directory, Cell low, Cell high,
                  Visit&& visit) {
  const Cell tile_low = grid.tile(low);
  const Cell tile_high = grid.tile(high);
  const auto visit_tile = [&](std::uint32_t slot, std::int32_t tx, std::int32_t ty) {
    const std::int32_t x0 = std::max(low.x, tx << grid.tile_bits);
    const std::int32_t x1 = std::min(high.x, ((tx + 1) << grid.tile_bits) - 1);
    const std::int32_t y0 = std::max(low.y, ty << grid.tile_bits);
    const std::int32_t y1 = std::min(high.y, ((ty + 1) << grid.tile_bits) - 1);
    for (std::int32_t y = y0; y <= y1; ++y)
      visit(slot, grid.in_tile({x0, y}), grid.in_tile({x1, y}) + 1, Cell{x0, y});
  };
  const auto wide = static_cast<std::int64_t>(tile_high.x) - tile_low.x + 1;
  const auto tall = static_cast<std::int64_t>(tile_high.y) - tile_low.y + 1;
  if (wide * tall > static_cast<std::int64_t>(directory.size())) {  // fewer tiles exist: test each of them
    for (std::uint32_t slot = 0; slot < directory.size(); ++slot) {
      const Cell tile = directory.tile(slot);
      if (tile_low.x <= tile.x && tile.x <= tile_high.x && tile_low.y <= tile.y && tile.y <= tile_high.y)
        visit_tile(slot, tile.x, tile.y);
    }
    return;
  }
  for (std::int32_t ty = tile_low.y; ty <= tile_high.y; ++ty) {
    for (std::int32_t tx = tile_low.x; tx <= tile_high.x; ++tx) {
      const std::uint32_t slot = directory.find({tx, ty});
      if (slot != TileDirectory::k_none) visit_tile(slot, tx, ty);
    }
  }
}

/// Visits the cells that a box (metres, world frame) touches, as for_each_run() above visits the cells of a
/// rectangle.
template <class Visit>
void for_each_run(const GridGeometry& grid, const TileDirectory& directory, const Box& box, Visit&& visit) {
  for_each_run(grid, directory, grid.cell(box.min), grid.cell(box.max), visit);
}

}  // namespace troupe::partition
