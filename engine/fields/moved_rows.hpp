#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe::engine {

/// Returns the indices of the elements that change their places if each element i of a list moves to the
/// place to[i]: all i with to[i] != i, in ascending order.
inline std::vector<std::uint32_t> moved_places(std::span<const std::uint32_t> to) {
  std::vector<std::uint32_t> moved;
  for (std::uint32_t i = 0; i < to.size(); ++i)
    if (to[i] != i) moved.push_back(i);
  return moved;
}

/// Moves each element i of `column` to the place to[i]. If the column is empty, it stays empty. Otherwise
/// `to` must contain each index of the column once, and `moved` must be moved_places(to).
template <class T>
void move_elements(std::vector<T>& column, std::span<const std::uint32_t> moved,
                   std::span<const std::uint32_t> to) {
  if (column.empty()) return;
  std::vector<T> elements;
  elements.reserve(moved.size());
  for (const std::uint32_t i : moved) elements.push_back(column[i]);
  for (std::size_t n = 0; n < moved.size(); ++n) column[to[moved[n]]] = elements[n];
}

}  // namespace troupe::engine
