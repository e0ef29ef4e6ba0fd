#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

namespace troupe::models {

/// A list in ascending order. If more than `most` elements are added, it keeps the lowest `most` of them.
template <class T, std::size_t most>
class Lowest {
 public:
  void add(const T& element) {
    T* const place = std::lower_bound(list_.data(), list_.data() + count_, element);
    const auto at = static_cast<std::size_t>(place - list_.data());
    if (at == most) return;
    count_ = std::min(count_ + 1, most);
    std::move_backward(place, list_.data() + count_ - 1, list_.data() + count_);
    list_[at] = element;
  }
  std::span<const T> list() const { return {list_.data(), count_}; }

 private:
  std::array<T, most> list_;
  std::size_t count_ = 0;
};

}  // namespace troupe::models
