#pragma once

#include "base/ids.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe {

// Sorts that many sources need. They are functions, not templates, because the sort of the standard library
// takes about as long to compile as 50 lines of code, in each source that calls it.

/// Sorts ids in ascending order.
void sort_ids(std::span<BodyId> ids);
/// Sorts ids in ascending order, and removes repeated ids.
void sort_unique(std::vector<BodyId>& ids);
/// Returns the indices 0 to keys.size() - 1 in the order of their keys: the index of the lowest key first.
/// Of equal keys, the one with the lower index comes first.
std::vector<std::size_t> sorted_order(std::span<const std::uint64_t> keys);

}  // namespace troupe
