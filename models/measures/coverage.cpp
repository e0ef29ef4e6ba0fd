#include "models/measures/coverage.hpp"

#include "base/limits.hpp"
#include "base/number_text.hpp"
#include "engine/observing/robot_sums.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

namespace troupe::models {
namespace {

using engine::Measure;
using engine::MeasuredWorld;
using engine::Unit;

constexpr double k_most_cells = 25e6;  // each takes two bytes of memory

/// The box whose cells are counted, m, world frame. It is the bounds of the world or, if the world has none,
/// the box around the static scene and the start positions of the robots.
Box ground_of(const MeasuredWorld& world, std::span<const BodyId> robots) {
  if (world.spec().bounds) return *world.spec().bounds;
  Box box = world.scene().bounds();
  for (const BodyId body : robots)
    if (world.spec().starts(body)) box.extend(world.spec().bodies[body.index()].pose_world_body.position());
  return box;
}

class Coverage : public Measure {
 public:
  struct Params {
    double cell = 1;

    static constexpr void describe(engine::Description<Params>& d) {
      d.member<&Params::cell>("cell", Unit::meters, engine::facts::within(0.001, k_world_reach_m),
                              "edge length of the square cells into which the ground is divided");
    }
  };

  Coverage(const MeasuredWorld& world, const Params& params, std::vector<BodyId> robots)
      : robots_(std::move(robots)), grid_{params.cell, 0} {
    const Box ground = ground_of(world, robots_);
    if (ground.empty()) return;
    const Vec2 size = ground.size() / grid_.cell_m;
    const double cells = (size.x() + 1) * (size.y() + 1);
    if (cells > k_most_cells)
      throw std::length_error(
          fmt::format("the ground has {} million cells of {} m, but at most {} million are allowed: give a "
                      "larger \"cell_m\"",
                      plain_number(cells / 1e6, 3), plain_number(grid_.cell_m), k_most_cells / 1e6));
    low_ = grid_.cell(ground.min);
    const partition::Cell high = grid_.cell(ground.max);
    columns_ = static_cast<std::size_t>(std::int64_t{high.x} - low_.x + 1);
    lines_ = static_cast<std::size_t>(std::int64_t{high.y} - low_.y + 1);
    free_.assign(columns_ * lines_, 0);
    memory_.assign(sizeof(Cells) + free_.size(), 0);
    visited_ = std::span(memory_).subspan(sizeof(Cells));
    for (std::size_t y = 0; y < lines_; ++y)
      for (std::size_t x = 0; x < columns_; ++x)
        free_[y * columns_ + x] = ground.contains({centre(low_.x, x), centre(low_.y, y)});
    for (const partition::FixedSolid& solid : world.scene().solids())
      if (solid.obstacle) take(solid.solid);
    free_cells_ = static_cast<std::size_t>(std::ranges::count(free_, 1));
  }

  void see(const MeasuredWorld& world) override {
    constexpr std::size_t k_block = 4096;
    world.parallel().for_batches(robots_.size(), k_block, [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i)
        if (const Row row = world.row(robots_[i]); world.is_there(row)) visit(world.transform(row).position);
    });
  }

  double value(const MeasuredWorld&) override {
    if (free_cells_ == 0) return std::numeric_limits<double>::quiet_NaN();
    std::size_t both = 0;
    for (std::size_t i = 0; i < free_.size(); ++i) both += free_[i] & visited_[i];
    return static_cast<double>(both) / static_cast<double>(free_cells_);
  }

  /// The memory begins with the cells to which it belongs. If it was saved in a world with other bounds, this
  /// function changes it, so that MeasureSet::remember() does not restore it.
  std::span<std::byte> memory() override {
    if (memory_.empty()) return {};
    const Cells cells{low_.x, low_.y, columns_, lines_};
    std::memcpy(memory_.data(), &cells, sizeof cells);
    return std::as_writable_bytes(std::span(memory_));
  }

 private:
  /// The cells of the ground: the indices of the first one in the grid, and how many there are.
  struct Cells {
    std::int32_t low_x, low_y;
    std::uint64_t columns, lines;
  };

  double centre(std::int32_t low, std::size_t i) const {
    return (low + static_cast<double>(i) + 0.5) * grid_.cell_m;
  }

  void visit(const Vec2& place) {
    const partition::Cell cell = grid_.cell(place);
    const std::int64_t x = std::int64_t{cell.x} - low_.x;
    const std::int64_t y = std::int64_t{cell.y} - low_.y;
    if (x < 0 || y < 0 || x >= static_cast<std::int64_t>(columns_) || y >= static_cast<std::int64_t>(lines_))
      return;
    // Several threads may write to one cell at the same time, but all of them write the same value.
    std::atomic_ref<std::uint8_t> visited(visited_[static_cast<std::size_t>(y) * columns_ + x]);
    if (visited.load(std::memory_order_relaxed) == 0) visited.store(1, std::memory_order_relaxed);
  }

  /// Marks the cells whose centres are in a solid as not free, by the even-odd rule. The edges of the solid
  /// cut each line of cell centres parallel to the x axis. The centres between the first and the second cut,
  /// between the third and the fourth, and so on, are inside the solid.
  void take(const Solid& solid) {
    Box box;
    for (const Ring& ring : solid.contours) box.extend(bounds(ring));
    if (box.empty()) return;
    // Only the lines from `first` to `end` - 1 can cross the solid.
    const std::size_t first = first_not_below(low_.y, lines_, box.min.y());
    const std::size_t end = first_not_below(low_.y, lines_, box.max.y());
    std::vector<std::vector<double>> crossings(end - first);
    for (const Ring& ring : solid.contours)
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vec2& a = ring[i];
        const Vec2& b = ring[(i + 1) % ring.size()];
        for (std::size_t y = first_not_below(low_.y, lines_, std::min(a.y(), b.y())); y < lines_; ++y) {
          const double height = centre(low_.y, y);
          if (height >= std::max(a.y(), b.y())) break;
          crossings[y - first].push_back(a.x() + (height - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
        }
      }
    for (std::size_t y = first; y < end; ++y) {
      std::vector<double>& cuts = crossings[y - first];
      std::ranges::sort(cuts);
      for (std::size_t i = 0; i + 1 < cuts.size(); i += 2)
        for (std::size_t x = first_not_below(low_.x, columns_, cuts[i]);
             x < columns_ && centre(low_.x, x) < cuts[i + 1]; ++x)
          free_[y * columns_ + x] = 0;
    }
  }

  /// The first of `count` cells along an axis whose centre has a coordinate of v (m) or more. `low` is the
  /// number of the first cell in the grid. Returns an index from 0, or `count` if there is no such cell.
  std::size_t first_not_below(std::int32_t low, std::size_t count, double v) const {
    const std::int64_t near = std::int64_t{grid_.cell({v, 0}).x} - low;
    auto i = static_cast<std::size_t>(std::clamp<std::int64_t>(near, 0, static_cast<std::int64_t>(count)));
    while (i < count && centre(low, i) < v) ++i;
    return i;
  }

  std::vector<BodyId> robots_;
  partition::GridGeometry grid_;
  partition::Cell low_;
  std::size_t columns_ = 0;
  std::size_t lines_ = 0;
  std::vector<std::uint8_t> free_;
  std::size_t free_cells_ = 0;
  std::vector<std::uint8_t> memory_;  // Cells, then visited_
  std::span<std::uint8_t> visited_;   // per cell: whether a robot has been there
};

}  // namespace

engine::MeasureKind coverage_measure() {
  return engine::make_measure_kind<Coverage>(
      "coverage", Unit::none, "fraction of the free ground that robots have visited",
      "The fraction of the free cells in which the origin of a robot has been at the end of some tick since "
      "measuring began. Cells are squares with edges of length `cell`; the world's origin is a corner of "
      "four of them. A cell is free if its centre is within the bounds of the world and in no static "
      "obstacle, whatever the height of the obstacle. If the world has no bounds, the box around the static "
      "geometry and the robots at the start is used instead. Cells that no robot can reach, such as those in "
      "a closed room, also count as free cells. Source, for single robots and teams: Koenig, Szymanski, Liu, "
      "Efficient and inefficient ant coverage methods, Annals of Mathematics and Artificial Intelligence 31, "
      "2001.",
      "|visited free cells| / |free cells|");
}

}  // namespace troupe::models
