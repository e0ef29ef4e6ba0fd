#include "partition/body_index.hpp"

#include <algorithm>
#include <atomic>

namespace troupe::partition {
namespace {

constexpr std::size_t k_block = 1024;  // rows a task

std::uint32_t add(std::uint32_t& counter, std::uint32_t n = 1) {
  return std::atomic_ref(counter).fetch_add(n, std::memory_order_relaxed);
}

/// visit(cell in its tile), block by block.
template <class Visit>
void for_each_cell_in_blocks(const GridGeometry& grid, Visit&& visit) {
  const std::int32_t tile = 1 << grid.tile_bits;
  const std::int32_t block = 1 << grid.block_bits();
  for (std::int32_t by = 0; by < tile; by += block)
    for (std::int32_t bx = 0; bx < tile; bx += block)
      for (std::int32_t y = by; y < by + block; ++y)
        for (std::int32_t x = bx; x < bx + block; ++x) visit(grid.in_tile({x, y}));
}

}  // namespace

void BodyIndex::rebuild(std::span<const Vec2> positions, std::span<const double> radii, Parallel& parallel) {
  const std::size_t rows = positions.size();
  positions_ = positions;
  radii_ = radii;
  const std::size_t blocks = (rows + k_block - 1) / k_block;
  const std::size_t cells = geometry_.cells_per_tile();
  const auto for_rows = [&](auto&& work) {
    parallel.for_each(blocks, [&](std::size_t b) {
      for (std::size_t r = b * k_block; r < std::min(rows, (b + 1) * k_block); ++r)
        work(static_cast<std::uint32_t>(r));
    });
  };
  const auto for_cells_of = [&](std::uint32_t r, auto&& visit) {
    if (!is_wide(r)) {
      visit(geometry_.cell(positions[r]), true);
      return;
    }
    const Cell home = geometry_.cell(positions[r]);
    const Box box = Box::around(positions[r], radii[r]);
    const Cell low = geometry_.cell(box.min);
    const Cell high = geometry_.cell(box.max);
    for (std::int32_t y = low.y; y <= high.y; ++y)
      for (std::int32_t x = low.x; x <= high.x; ++x) visit(Cell{x, y}, Cell{x, y} == home);
  };

  // Tiles are made where bodies enter new ground: seldom, so one thread does it. A tile stays until many more
  // are known than there are bodies.
  if (directory_.size() > 64 + 4 * rows) directory_.clear();
  std::atomic<bool> new_ground = false;
  for_rows([&](std::uint32_t r) {
    for_cells_of(r, [&](Cell c, bool) {
      if (directory_.find(geometry_.tile(c)) == TileDirectory::k_none)
        new_ground.store(true, std::memory_order_relaxed);
    });
  });
  small_radius_ = 0;
  has_wide_ = false;
  for (std::uint32_t r = 0; r < rows; ++r) {
    if (is_wide(r))
      has_wide_ = true;
    else
      small_radius_ = std::max(small_radius_, radii[r]);
    if (new_ground.load(std::memory_order_relaxed))
      for_cells_of(r, [&](Cell c, bool) { directory_.insert(geometry_.tile(c)); });
  }

  // Count, sum, scatter. The scatter's order within a cell depends on who came first; the sort that follows
  // takes that away.
  const std::size_t slots = directory_.size();
  next_.assign(slots * cells, 0);
  tile_rows_.assign(slots, 0);
  homes_.resize(rows);
  for_rows([&](std::uint32_t r) {
    for_cells_of(r, [&](Cell c, bool home) {
      const std::uint32_t slot = directory_.find(geometry_.tile(c));
      const auto place = static_cast<std::uint32_t>(slot * cells + geometry_.in_tile(c));
      add(next_[place]);
      if (!home) return;
      add(tile_rows_[slot]);
      homes_[r] = place;
    });
  });
  begins_.resize(slots * cells + 1);
  tile_begins_.resize(slots);
  std::uint32_t sum = 0;
  std::uint32_t homes = 0;
  for (std::size_t slot = 0; slot < slots; ++slot) {
    tile_begins_[slot] = homes;
    homes += tile_rows_[slot];
    for (std::size_t c = slot * cells; c < (slot + 1) * cells; ++c) {
      begins_[c] = sum;
      sum += next_[c];
      next_[c] = begins_[c];
    }
  }
  begins_.back() = sum;
  circles_.resize(sum);
  order_.resize(rows);
  for_rows([&](std::uint32_t r) {
    for_cells_of(r, [&](Cell c, bool) {
      const std::uint32_t slot = directory_.find(geometry_.tile(c));
      circles_[add(next_[slot * cells + geometry_.in_tile(c)])] = enclosing_circle(positions[r], radii[r], r);
    });
  });
  parallel.for_each(slots, [&](std::size_t slot) {
    std::uint32_t home = tile_begins_[slot];
    for_each_cell_in_blocks(geometry_, [&](std::size_t in_tile) {
      const std::size_t c = slot * cells + in_tile;
      const std::span<BodyCircle> cell(circles_.data() + begins_[c], begins_[c + 1] - begins_[c]);
      std::ranges::sort(cell, {}, &BodyCircle::row);
      for (const BodyCircle& circle : cell)
        if (homes_[circle.row] == c) order_[home++] = circle.row;
    });
  });
}

bool BodyIndex::first_meeting(std::uint32_t row, Cell query_low, Cell run_cell, const std::uint32_t* begin,
                              std::size_t first, std::size_t last, std::uint32_t i) const {
  const Cell low = geometry_.cell(Box::around(positions_[row], radii_[row]).min);
  const Cell lowest{std::max(low.x, query_low.x), std::max(low.y, query_low.y)};
  if (lowest.y != run_cell.y || lowest.x < run_cell.x) return false;
  const std::size_t cell = first + static_cast<std::size_t>(lowest.x - run_cell.x);
  return cell < last && begin[cell] <= i && i < begin[cell + 1];
}

}  // namespace troupe::partition
