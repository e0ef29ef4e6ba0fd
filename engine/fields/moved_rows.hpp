#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe::engine {

/// Returns the indices i, ascending, for which to[i] differs from i. These elements of a list change their
/// places when each element i moves to the place to[i].
inline std::vector<std::uint32_t> moved_places(std::span<const std::uint32_t> to) {
  std::vector<std::uint32_t> moved;
  for (std::uint32_t i = 0; i < to.size(); ++i)
    if (to[i] != i) moved.push_back(i);
  return moved;
}

/// Moves each element i of a list to the place to[i]. `to` must have each index of the list once, and `moved`
/// must be moved_places(to). An empty list stays empty.
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
