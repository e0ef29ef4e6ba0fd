#include "partition/body_index.hpp"

#include "base/capacity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <stdexcept>
#include <utility>

namespace troupe::partition {
namespace {

constexpr std::size_t k_least_part = 256;      // least rows that a task counts
constexpr std::size_t k_most_parts = 64;       // each part has a counter for each tile
constexpr std::size_t k_parts_per_thread = 4;  // for even loads of the threads
constexpr std::size_t k_sorted = 512;          // least rows that a task sorts into cells
constexpr std::size_t k_empty = 32;            // an empty tile takes as long to sort as this many rows
constexpr std::size_t k_summed = 2048;         // tiles that a task sums up; fewer are not worth a thread
constexpr std::size_t k_read_beyond = 3;       // circles that unpack() may read beyond the end

/// Visits the cells of a tile block by block. Calls visit(index of the first cell, index one past the last)
/// for each row of cells of each block; see GridGeometry::in_tile() for the index.
template <class Visit>
void for_each_line_in_blocks(const GridGeometry& grid, Visit&& visit) {
  const std::int32_t tile = 1 << grid.tile_bits;
  const std::int32_t block = 1 << grid.block_bits();
  for (std::int32_t by = 0; by < tile; by += block)
    for (std::int32_t bx = 0; bx < tile; bx += block)
      for (std::int32_t y = by; y < by + block; ++y) {
        const std::size_t first = grid.in_tile({bx, y});
        visit(first, first + static_cast<std::size_t>(block));
      }
}

/// Resizes a list that may contain entries of wide bodies (bodies wider than a cell, see BodyIndex). A wide
/// body has an entry in each cell that it touches, so the size of the list varies slightly as bodies move. If
/// the list must grow, memory for a quarter more is reserved; otherwise many ticks would allocate memory.
template <typename T>
void resize_generously(std::vector<T>& list, std::size_t size) {
  if (size > list.capacity()) list.reserve(size + size / 4);
  list.resize(size);
}

}  // namespace

void BodyIndex::reserve(const Box& ground) {
  constexpr double k_within_reason = 1 << 14;
  if (ground.empty()) return;
  const Vec2 size = ground.size() / geometry_.tile_m();
  reserved_ = static_cast<std::size_t>(std::min((size.x() + 2) * (size.y() + 2), k_within_reason));
  directory_.reserve(reserved_);
  counts_.reserve(reserved_);
  tiles_.reserve(reserved_ + 1);
  constexpr std::size_t k_most_cells = 1 << 22;
  begins_.reserve(std::min(reserved_ * geometry_.cells_per_tile(), k_most_cells) + 1);
}

/// Calls visit(tile) for each tile that the row's body touches. If the body is huge or not wide, calls it
/// only for the tile of the body's origin.
template <class Visit>
void BodyIndex::for_each_tile_of(std::uint32_t row, Visit&& visit) const {
  if (!is_in_many_cells(row)) {
    visit(geometry_.tile(home_cell(row)));
    return;
  }
  const Box box = Box::around(places_[row].position, radii_[row]);
  const Cell low = geometry_.tile(geometry_.cell(box.min));
  const Cell high = geometry_.tile(geometry_.cell(box.max));
  for (std::int32_t y = low.y; y <= high.y; ++y)
    for (std::int32_t x = low.x; x <= high.x; ++x) visit(Cell{x, y});
}

/// Calls visit(index of the cell in the tile, whether the cell contains the body's origin) for those cells of
/// the tile in which the row is listed.
template <class Visit>
void BodyIndex::for_each_cell_within(std::uint32_t row, Cell tile, Visit&& visit) const {
  if (!is_in_many_cells(row)) {
    visit(homes_[row] & (geometry_.cells_per_tile() - 1), true);
    return;
  }
  const Cell home = home_cell(row);
  const Box box = Box::around(places_[row].position, radii_[row]);
  const std::int32_t edge = 1 << geometry_.tile_bits;
  const Cell low = geometry_.cell(box.min);
  const Cell high = geometry_.cell(box.max);
  const std::int32_t x0 = tile.x << geometry_.tile_bits;
  const std::int32_t y0 = tile.y << geometry_.tile_bits;
  for (std::int32_t y = std::max(low.y, y0); y <= std::min(high.y, y0 + edge - 1); ++y)
    for (std::int32_t x = std::max(low.x, x0); x <= std::min(high.x, x0 + edge - 1); ++x)
      visit(geometry_.in_tile({x, y}), Cell{x, y} == home);
}

/// Counts the part's rows per tile in part.next, and collects tiles that have no slot yet in part.new_tiles.
/// Also stores the cell of each row's origin in homes_.
void BodyIndex::count(Part& part) {
  const std::size_t cells = geometry_.cells_per_tile();
  part.next.assign(directory_.size(), 0);
  part.new_tiles.clear();
  part.small_radius = 0;
  part.has_wide = false;
  part.huge = 0;
  Cell last_tile;
  std::uint32_t last_slot = TileDirectory::k_none;
  // The search is skipped if the previous row was in the same tile, which is often the case.
  const auto slot_of = [&](Cell tile) {
    if (last_slot == TileDirectory::k_none || !(tile == last_tile)) {
      last_tile = tile;
      last_slot = directory_.find(tile);
      if (last_slot == TileDirectory::k_none) part.new_tiles.push_back(tile);
    }
    return last_slot;
  };
  for (std::uint32_t row = part.first; row < part.last; ++row) {
    if (!is_there(row)) continue;
    const Cell home = home_cell(row);
    if (is_wide(row)) {
      part.has_wide = true;
      part.huge += is_huge(row);
      for_each_tile_of(row, [&](Cell tile) {
        if (const std::uint32_t slot = slot_of(tile); slot != TileDirectory::k_none) ++part.next[slot];
      });
      if (const std::uint32_t slot = slot_of(geometry_.tile(home)); slot != TileDirectory::k_none)
        homes_[row] = static_cast<std::uint32_t>(slot * cells + geometry_.in_tile(home));
      continue;
    }
    part.small_radius = std::max(part.small_radius, radii_[row]);
    const std::uint32_t slot = slot_of(geometry_.tile(home));
    if (slot == TileDirectory::k_none) continue;
    ++part.next[slot];
    homes_[row] = static_cast<std::uint32_t>(slot * cells + geometry_.in_tile(home));
  }
}

/// Adds the tiles that bodies have newly entered. This is rare, so one thread adds them, and the parts that
/// found such tiles count their rows again.
void BodyIndex::make_new_tiles(Parallel& parallel) {
  const auto has_new = [](const Part& part) { return !part.new_tiles.empty(); };
  if (std::ranges::none_of(parts_, has_new)) return;
  for (const Part& part : parts_)
    for (const Cell tile : part.new_tiles) directory_.insert(tile);
  parallel.for_each(parts_.size(), [&](std::size_t p) {
    if (has_new(parts_[p]))
      count(parts_[p]);
    else
      parts_[p].next.resize(directory_.size(), 0);
  });
}

/// Divides the rows into parts, gives each tile that a body touches a slot, and counts the rows of each part
/// per tile.
void BodyIndex::find_tiles(Parallel& parallel) {
  const std::size_t rows = places_.size();
  // A tile stays in the directory after all bodies have left it. The directory is cleared only when there are
  // far more tiles than rows, or when the numbers of the cells in homes_ could overflow.
  constexpr std::uint64_t k_most_cells = std::numeric_limits<std::uint32_t>::max();
  const std::size_t cells = geometry_.cells_per_tile();
  if (directory_.size() > 16 + 4 * rows || (directory_.size() + rows) * cells > k_most_cells)
    directory_.clear();

  parts_.resize(std::clamp<std::size_t>(rows / k_least_part, 1,
                                        std::min(k_most_parts, k_parts_per_thread * parallel.threads())));
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    parts_[p].next.reserve(reserved_);
    parts_[p].new_tiles.reserve(16);
    parts_[p].first = static_cast<std::uint32_t>(rows * p / parts_.size());
    parts_[p].last = static_cast<std::uint32_t>(rows * (p + 1) / parts_.size());
  }
  parallel.for_each(parts_.size(), [&](std::size_t p) { count(parts_[p]); });
  make_new_tiles(parallel);
  if (directory_.size() * cells > k_most_cells)
    throw std::length_error(fmt::format(
        "the spatial index of the bodies would have {} cells; at most {} are allowed: set a smaller "
        "WorldOptions::tile_size_m (--tile-size)",
        directory_.size() * cells, k_most_cells));
}

void BodyIndex::rebuild(std::span<const Transform> places, std::span<const double> radii,
                        Parallel& parallel) {
  static std::atomic<std::uint64_t> versions = 0;
  version_ = ++versions;
  const std::size_t rows = places.size();
  places_ = places;
  radii_ = radii;
  if (rows != homes_.size()) {
    resize_with_capacity(homes_, rows);
    tile_rows_.clear();
    circles_.clear();
    order_.clear();
    // Memory is reserved for all rows, also for those of absent bodies, so that later ticks do not allocate.
    change_capacity(tile_rows_, rows);
    change_capacity(circles_, rows + k_read_beyond);
    change_capacity(order_, rows);
  }
  find_tiles(parallel);

  // Compute where the rows of each part go in each tile.
  small_radius_ = 0;
  has_wide_ = false;
  huge_ = 0;
  for (const Part& part : parts_) {
    huge_ += part.huge;
    small_radius_ = std::max(small_radius_, part.small_radius);
    has_wide_ = has_wide_ || part.has_wide;
  }
  const std::size_t slots = directory_.size();
  const std::size_t cells = geometry_.cells_per_tile();
  const auto for_each_tile = [&](auto&& work) {
    const std::size_t tasks = std::clamp<std::size_t>((rows + k_empty * slots) / k_sorted, 1, slots + 1);
    parallel.for_each(tasks, [&](std::size_t t) {
      for (std::size_t slot = slots * t / tasks; slot < slots * (t + 1) / tasks; ++slot) work(slot);
    });
  };
  counts_.resize(slots);
  for_each_tile([&](std::size_t slot) {
    std::uint32_t count = 0;
    for (Part& part : parts_) count += std::exchange(part.next[slot], count);
    counts_[slot] = {count, count, count};
  });
  place_tiles(parallel);
  resize_generously(tile_rows_, tiles_[slots].rows);
  parallel.for_each(parts_.size(), [&](std::size_t p) {
    Part& part = parts_[p];
    const auto append = [&](std::size_t slot, const BodyCircle& circle) {
      tile_rows_[tiles_[slot].rows + part.next[slot]++] = circle;
    };
    for (std::uint32_t row = part.first; row < part.last; ++row) {
      if (!is_there(row)) continue;
      const BodyCircle circle = enclosing_circle(places_[row].position, radii_[row], row);
      if (!part.has_wide || !is_wide(row))
        append(homes_[row] >> (2 * geometry_.tile_bits), circle);
      else
        for_each_tile_of(row, [&](Cell tile) { append(directory_.find(tile), circle); });
    }
  });
  if (has_wide_) {
    for_each_tile([&](std::size_t slot) { weigh_tile(slot); });
    place_tiles(parallel);
  }
  resize_generously(circles_, tiles_[slots].circles + huge_ + k_read_beyond);
  order_.resize(tiles_[slots].homes);
  begins_.resize(slots * cells + 1);
  begins_.back() = tiles_[slots].circles;
  for_each_tile([&](std::size_t slot) { sort_tile(slot); });
  if (huge_ > 0) list_huge();
}

/// Computes tiles_ (where each tile starts in each array) from counts_ (the sizes of the tiles), by a
/// parallel prefix sum.
void BodyIndex::place_tiles(Parallel& parallel) {
  const std::size_t slots = counts_.size();
  tiles_.resize(slots + 1);
  sums_.resize((slots + k_summed - 1) / k_summed);
  parallel.for_batches(slots, k_summed, [&](std::size_t first, std::size_t end) {
    Tile sum;
    for (std::size_t slot = first; slot < end; ++slot) sum += counts_[slot];
    sums_[first / k_summed] = sum;
  });
  Tile sum;
  for (Tile& start : sums_) {
    const Tile next = start;
    start = sum;
    sum += next;
  }
  tiles_[slots] = sum;
  parallel.for_batches(slots, k_summed, [&](std::size_t first, std::size_t end) {
    Tile start = sums_[first / k_summed];
    for (std::size_t slot = first; slot < end; ++slot) {
      tiles_[slot] = start;
      start += counts_[slot];
    }
  });
}

/// Counts the entries of a tile in circles_ and the rows of bodies whose origin is in the tile. If there are
/// wide bodies, a tile may have more circles than rows, and its rows may include bodies with their origin in
/// another tile.
void BodyIndex::weigh_tile(std::size_t slot) {
  const Cell tile = directory_.tile(static_cast<std::uint32_t>(slot));
  Tile& count = counts_[slot];
  count.circles = count.homes = 0;
  for (std::uint32_t i = tiles_[slot].rows; i < tiles_[slot + 1].rows; ++i) {
    for_each_cell_within(tile_rows_[i].row, tile, [&](std::size_t, bool home) {
      ++count.circles;
      count.homes += home;
    });
  }
}

/// Sorts the rows of a tile by cell with a counting sort, and writes them to circles_ and order_.
void BodyIndex::sort_tile(std::size_t slot) {
  const std::size_t cells = geometry_.cells_per_tile();
  const Cell tile = directory_.tile(static_cast<std::uint32_t>(slot));
  const std::span<const BodyCircle> rows(tile_rows_.data() + tiles_[slot].rows,
                                         tiles_[slot + 1].rows - tiles_[slot].rows);
  const std::span<std::uint32_t> begins(&begins_[slot * cells], cells);
  std::uint32_t sum = tiles_[slot].circles;
  if (rows.empty()) {
    std::ranges::fill(begins, sum);
    return;
  }
  const auto for_each_cell = [&](std::uint32_t row, auto&& visit) {
    if (has_wide_)
      for_each_cell_within(row, tile, visit);
    else
      visit(homes_[row] & (cells - 1), true);  // cells is a power of two
  };
  std::ranges::fill(begins, 0);
  for (const BodyCircle& circle : rows)
    for_each_cell(circle.row, [&](std::size_t cell, bool) { ++begins[cell]; });
  for (std::uint32_t& begin : begins) sum += std::exchange(begin, sum);
  for (const BodyCircle& circle : rows)
    for_each_cell(circle.row, [&](std::size_t cell, bool) { circles_[begins[cell]++] = circle; });
  // Each begin has advanced to the end of its cell, which is where the next cell begins.
  std::shift_right(begins.begin(), begins.end(), 1);
  begins[0] = tiles_[slot].circles;

  std::uint32_t* out = order_.data() + tiles_[slot].homes;
  for_each_line_in_blocks(geometry_, [&](std::size_t first, std::size_t last) {
    const auto begin = [&](std::size_t cell) { return cell < cells ? begins[cell] : sum; };
    if (!has_wide_) {
      for (std::uint32_t i = begin(first); i < begin(last); ++i) *out++ = circles_[i].row;
      return;
    }
    for (std::size_t cell = first; cell < last; ++cell)
      for (std::uint32_t i = begin(cell); i < begin(cell + 1); ++i)
        if (homes_[circles_[i].row] == slot * cells + cell) *out++ = circles_[i].row;
  });
}

/// Writes the list of huge bodies behind the entries of the cells.
void BodyIndex::list_huge() {
  BodyCircle* out = &circles_[begins_.back()];
  for (const Part& part : parts_) {
    if (part.huge == 0) continue;
    for (std::uint32_t row = part.first; row < part.last; ++row)
      if (is_huge(row)) *out++ = enclosing_circle(places_[row].position, radii_[row], row);
  }
}

bool BodyIndex::first_meeting(std::uint32_t row, Cell query_low, Cell run_cell, const std::uint32_t* begin,
                              std::size_t first, std::size_t last, std::uint32_t i) const {
  if (is_huge(row)) return false;
  const Cell low = geometry_.cell(Box::around(places_[row].position, radii_[row]).min);
  const Cell lowest{std::max(low.x, query_low.x), std::max(low.y, query_low.y)};
  if (lowest.y != run_cell.y || lowest.x < run_cell.x) return false;
  const std::size_t cell = first + static_cast<std::size_t>(lowest.x - run_cell.x);
  return cell < last && begin[cell] <= i && i < begin[cell + 1];
}

}  // namespace troupe::partition
