#include "partition/box_grid.hpp"

#include <algorithm>
#include <cmath>

namespace troupe::partition {

std::size_t BoxGrid::place(double offset, double cell, std::size_t count) {
  return static_cast<std::size_t>(std::clamp(offset / cell, 0.0, static_cast<double>(count - 1)));
}

BoxGrid::BoxGrid(std::span<const Box> boxes) {
  constexpr double k_most = 1024;     // cells per edge of the grid
  constexpr std::size_t k_many = 64;  // a box that touches more cells is stored in wide_
  double count = 0;
  for (const Box& box : boxes) {
    if (box.empty()) continue;
    ground_.extend(box);
    ++count;
  }
  if (count == 0) return;
  columns_ = lines_ = static_cast<std::size_t>(std::clamp(std::ceil(sqrt(count)), 1.0, k_most));
  cell_ = (ground_.size() / static_cast<double>(columns_)).cwiseMax(1e-9);

  std::vector<std::uint32_t> next(columns_ * lines_ + 1, 0);
  const auto for_each_cell = [&](const Box& box, auto&& visit) {
    const std::size_t x0 = column(box.min.x());
    const std::size_t x1 = column(box.max.x());
    const std::size_t y0 = line(box.min.y());
    const std::size_t y1 = line(box.max.y());
    if ((x1 - x0 + 1) * (y1 - y0 + 1) > k_many) return false;
    for (std::size_t y = y0; y <= y1; ++y)
      for (std::size_t x = x0; x <= x1; ++x) visit(y * columns_ + x);
    return true;
  };
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    if (!boxes[i].empty() && !for_each_cell(boxes[i], [&](std::size_t cell) { ++next[cell + 1]; }))
      wide_.push_back(i);
  for (std::size_t cell = 1; cell < next.size(); ++cell) next[cell] += next[cell - 1];
  begins_ = next;
  boxes_.resize(next.back());
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    if (!boxes[i].empty()) for_each_cell(boxes[i], [&](std::size_t cell) { boxes_[next[cell]++] = i; });
}

}  // namespace troupe::partition
