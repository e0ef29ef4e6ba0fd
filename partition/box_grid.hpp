#pragma once

#include "base/geometry.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace troupe::partition {

/// Boxes that never move, by the cells of a square grid that they touch: about as many cells as boxes. A box
/// that covers many cells is listed once, apart, so that a floor plan among a thousand crates costs no more
/// than a crate.
class BoxGrid {
 public:
  BoxGrid() = default;
  /// Empty boxes are never found.
  explicit BoxGrid(std::span<const Box> boxes);

  /// visit(index of the box) -> stop?, for those that may touch this one, each once or more, until one stops;
  /// says whether one did.
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
  std::vector<std::uint32_t> begins_;  // per cell, one closing entry: into boxes_
  std::vector<std::uint32_t> boxes_;
  std::vector<std::uint32_t> wide_;
};

}  // namespace troupe::partition
