#pragma once

#include "base/geometry.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace troupe::partition {

/// An index of static boxes by the grid cells that they touch. The grid has about as many cells as there are
/// boxes, but at most 1024 x 1024. A box that covers more than 64 cells, such as the box of a floor plan
/// among a thousand crates, is kept in a separate list instead of in each of its cells. Every query visits
/// the boxes of that list.
class BoxGrid {
 public:
  BoxGrid() = default;
  /// Indexes the boxes. Queries report a box by its position in `boxes` and never report an empty box.
  explicit BoxGrid(std::span<const Box> boxes);

  /// Calls visit(i), with the index i of an indexed box, until a call returns true, and returns whether a
  /// call did. If none does, visit() is called at least once for each indexed box that touches `box`, and
  /// also for some that do not touch it.
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
