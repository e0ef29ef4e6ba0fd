#pragma once

#include <cstddef>
#include <iterator>
#include <vector>

namespace troupe {

/// Returns the capacity that a list should have when its size changes. The list keeps its capacity unless it
/// is too small or far too large, so that small changes of its size do not allocate memory:
///
/// - If the capacity is 0, the result is `size`.
/// - If the capacity is less than `size`, or more than about one and a half times `size`, the result is
///   `size` plus 3 % spare elements.
/// - Otherwise the result is the present capacity.
///
/// size: new number of elements of the list
/// capacity: present capacity of the list
inline std::size_t capacity_for(std::size_t size, std::size_t capacity) {
  constexpr std::size_t k_small = 8;  // elements that are not worth freeing
  if (capacity == 0) return size;
  return size > capacity || size + size / 2 + k_small < capacity ? size + size / 32 : capacity;
}

/// Prepares a list for `size` elements: changes its capacity to capacity_for(size, present capacity). The
/// list keeps its elements. It must not have more than `size` elements.
template <class T>
void change_capacity(std::vector<T>& list, std::size_t size) {
  const std::size_t capacity = capacity_for(size, list.capacity());
  if (capacity == list.capacity()) return;
  std::vector<T> moved;
  moved.reserve(capacity);
  moved.assign(std::make_move_iterator(list.begin()), std::make_move_iterator(list.end()));
  list.swap(moved);
}

/// Resizes a list to `size` elements, and changes its capacity as change_capacity() does. New elements are
/// copies of `value`.
template <class T>
void resize_with_capacity(std::vector<T>& list, std::size_t size, const T& value = T()) {
  if (size < list.size()) list.erase(list.begin() + static_cast<std::ptrdiff_t>(size), list.end());
  change_capacity(list, size);
  list.resize(size, value);
}

/// Returns freed memory to the operating system, as far as the C library can. Otherwise the process may keep
/// memory that it has freed. Call it after freeing much memory that will not be needed again. Thread-safe.
void release_freed_memory();

}  // namespace troupe
