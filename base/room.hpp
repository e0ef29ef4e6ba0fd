#pragma once

#include <cstddef>
#include <iterator>
#include <vector>

namespace troupe {

/// Returns the number of elements for which a list should have memory. size: the number of elements for which
/// the list needs memory; room: the number for which it has memory. The result is `room`, unless `room` is
/// less than `size`, or more than about one and a half times `size`. In these two cases the result is `size`
/// plus 3 % spare elements, so that a list whose size varies slightly keeps its memory. If `room` is 0, the
/// result is exactly `size`.
inline std::size_t room_for(std::size_t size, std::size_t room) {
  constexpr std::size_t k_small = 8;  // elements that are not worth freeing
  if (room == 0) return size;
  return size > room || size + size / 2 + k_small < room ? size + size / 32 : room;
}

/// Changes the capacity of a list to room_for(size, its present capacity). The list must have at most `size`
/// elements, which it keeps.
template <class T>
void make_room(std::vector<T>& list, std::size_t size) {
  const std::size_t room = room_for(size, list.capacity());
  if (room == list.capacity()) return;
  std::vector<T> moved;
  moved.reserve(room);
  moved.assign(std::make_move_iterator(list.begin()), std::make_move_iterator(list.end()));
  list.swap(moved);
}

/// Resizes a list to `size` elements, and changes its capacity as make_room() does. New elements are copies
/// of `value`.
template <class T>
void resize_with_room(std::vector<T>& list, std::size_t size, const T& value = T()) {
  if (size < list.size()) list.erase(list.begin() + static_cast<std::ptrdiff_t>(size), list.end());
  make_room(list, size);
  list.resize(size, value);
}

/// Returns freed memory to the operating system, as far as the C library can. Without this call, the process
/// may keep the pages of freed lists. Call it after much memory was freed that will not be needed again.
/// Thread-safe.
void release_freed_memory();

}  // namespace troupe
