#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe::engine {

/// The indices, ascending, of the elements that change their places if each element i of a list goes to the
/// place to[i].
inline std::vector<std::uint32_t> moved_places(std::span<const std::uint32_t> to) {
  std::vector<std::uint32_t> moved;
  for (std::uint32_t i = 0; i < to.size(); ++i)
    if (to[i] != i) moved.push_back(i);
  return moved;
}

/// Moves each element i of a column to the place to[i]. An empty column stays empty. moved: moved_places(to)
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
