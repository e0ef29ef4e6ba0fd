#include "base/sort.hpp"

#include <algorithm>
#include <utility>

namespace troupe {

void sort_ids(std::span<BodyId> ids) { std::ranges::sort(ids); }

void sort_unique(std::vector<BodyId>& ids) {
  sort_ids(ids);
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
}

std::vector<std::size_t> sorted_order(std::span<const std::uint64_t> keys) {
  std::vector<std::pair<std::uint64_t, std::size_t>> pairs;
  pairs.reserve(keys.size());
  for (const std::uint64_t key : keys) pairs.emplace_back(key, pairs.size());
  std::ranges::sort(pairs);
  std::vector<std::size_t> order;
  order.reserve(keys.size());
  for (const auto& [key, index] : pairs) order.push_back(index);
  return order;
}

}  // namespace troupe
