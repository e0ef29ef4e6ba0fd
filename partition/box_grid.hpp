#pragma once

#include "base/geometry.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace troupe::partition {

/// A spatial index of static boxes. Each cell of a grid lists the boxes that touch the cell. The grid has
/// about as many cells as there are boxes, but at most 1024 x 1024. A box that touches more than 64 cells,
/// such as the box of a large building among a thousand crates, is kept in a separate list instead. Every
/// query visits all boxes of that list.
class BoxGrid {
 public:
  BoxGrid() = default;
  /// Indexes the boxes. Queries identify a box by its index in `boxes` and never visit an empty box.
  explicit BoxGrid(std::span<const Box> boxes);

  /// Calls visit(i) for each indexed box that touches `box`, and for some that do not; i is the index of the
  /// indexed box. A box may be visited several times. The first call that returns true ends the search, and
  /// any_near() then returns true. If no call returns true, any_near() returns false.
  template <class Visit>
  bool any_near(const Box& box, Visit&& visit) const {
    for (const std::uint32_t i : wide_)
      if (visit(i)) return true;
    if (begins_.empty() || !box.touches(ground_)) return false;
    const std::size_t x0 = column(box.min.x());
    const std::size_t x1 = column(box.max.x());
    const std::size_t y1 = line(box.max.y());
    for (std::size_t y = line(box.min.y()); y <= y1; ++y)
      for (std::uint32_t i = begins_[y * columns_ + x0]; i < begins_[y * columns_ + x1 + 1]; ++i)
        if (visit(boxes_[i])) return true;
    return false;
  }

 private:
  static std::size_t place(double offset, double cell, std::size_t count);
  std::size_t column(double x) const { return place(x - ground_.min.x(), cell_.x(), columns_); }
  std::size_t line(double y) const { return place(y - ground_.min.y(), cell_.y(), lines_); }

  Box ground_;
  Vec2 cell_ = Vec2::Ones();
  std::size_t columns_ = 0;
  std::size_t lines_ = 0;
  std::vector<std::uint32_t> begins_;  // per cell, and one past the end: index into boxes_
  std::vector<std::uint32_t> boxes_;   // indices of boxes, by cell
  std::vector<std::uint32_t> wide_;    // indices of the boxes that cover many cells
};

}  // namespace troupe::partition
