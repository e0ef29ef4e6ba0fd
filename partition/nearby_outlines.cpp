#include "partition/nearby_outlines.hpp"

#include "base/math.hpp"
#include "partition/ranging.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace troupe::partition {
namespace {

/// Divides the cells of the rectangle [low, high] that are not in the rectangle [inner_low, inner_high] into
/// at most four rectangles, and calls visit(low, high) for each. The inner rectangle must be inside the outer
/// one; `low` and `high` are cells of opposite corners, both included.
template <class Visit>
void for_each_rectangle(Cell low, Cell high, Cell inner_low, Cell inner_high, Visit&& visit) {
  if (low.y < inner_low.y) visit(low, Cell{high.x, inner_low.y - 1});
  if (low.x < inner_low.x) visit(Cell{low.x, inner_low.y}, Cell{inner_low.x - 1, inner_high.y});
  if (inner_high.x < high.x) visit(Cell{inner_high.x + 1, inner_low.y}, Cell{high.x, inner_high.y});
  if (inner_high.y < high.y) visit(Cell{low.x, inner_high.y + 1}, high);
}

}  // namespace

void NearbyOutlines::begin(const BodyIndex& bodies, const FixedOutlines& fixed, double reach) {
  if (bodies_ == &bodies && version_ == bodies.version() && version_ != 0 && fixed_ == &fixed &&
      reach_ == reach)
    return;
  bodies_ = &bodies;
  version_ = bodies.version();
  fixed_ = &fixed;
  reach_ = reach;
  home_.reset();
  radii_.clear();
  // A search for bodies within a radius visits the cells up to this radius plus the largest radius of a body
  // that is not wide. Each radius but the last is chosen such that this sum is a whole number of cells. The
  // bands of bodies therefore end at cell borders.
  for (double cells = 2;; cells *= 2) {
    const double radius = cells * bodies.geometry().cell_m - bodies.largest_small_radius();
    if (radius >= reach) break;
    radii_.push_back(radius);
  }
  radii_.push_back(reach);
}

void NearbyOutlines::set_block_of(const Vec2& point) {
  const GridGeometry& geometry = bodies_->geometry();
  const Cell block = geometry.block(geometry.cell(point));
  if (home_ == block) return;
  home_ = block;
  ends_.clear();
}

void NearbyOutlines::gather(std::size_t band) {
  const Box block = bodies_->geometry().box_of_block(*home_);
  std::size_t size = ends_.empty() ? 0 : ends_.back();
  const auto gather_from = [&](const auto& grid, std::size_t ring, double largest_radius,
                               std::uint32_t mark) {
    std::size_t runs = 0;
    std::size_t unpacked = size;
    const auto unpack_runs = [&] {
      circles_.change_capacity(size + k_circle_padding);
      unpack({runs_.data(), runs}, mark, unpacked, circles_);
      unpacked = size;
      runs = 0;
    };
    const auto append = [&](CircleRun run) {
      if (runs == runs_.size()) unpack_runs();
      runs_[runs++] = run;
      size += run.size();
    };
    // The radius is reduced slightly, so that a ring that ends at a cell border does not touch the next cell.
    const auto around = [&](double radius) {
      const Box box = block.expanded((radius + largest_radius) * (1 - 1e-12));
      return std::pair(grid.geometry().cell(box.min), grid.geometry().cell(box.max));
    };
    const auto [low, high] = around(radii_[ring]);
    if (ring == 0) {
      grid.for_each_run(low, high, append);
    } else {
      const auto [inner_low, inner_high] = around(radii_[ring - 1]);
      for_each_rectangle(low, high, inner_low, inner_high,
                         [&](Cell from, Cell to) { grid.for_each_run(from, to, append); });
    }
    unpack_runs();
  };
  const auto gather_ring = [&](std::size_t ring) {
    gather_from(*bodies_, ring, bodies_->largest_small_radius(), 0);
    gather_from(*fixed_, ring, fixed_->largest_radius(), k_fixed);
  };
  if (band > 0) {
    gather_ring(joined_ + band);
  } else {
    joined_ = 0;
    gather_ring(0);
    while (size < k_least_in_band_0 && joined_ + 1 < radii_.size()) gather_ring(++joined_);
    const double side = block.size().x() + 2 * radius(0);
    const auto found = static_cast<double>(size);
    nearest_shell_m_ = found <= k_most_in_one_search
                           ? std::numeric_limits<double>::infinity()
                           : std::min(radius(0), side * sqrt(k_nearest_shell_circles / (k_pi * found)));
  }
  while (size % k_circle_padding != 0)
    circles_.set(size++, {0, 0, -std::numeric_limits<float>::infinity(), 0});
  ends_.push_back(size);
}

}  // namespace troupe::partition
