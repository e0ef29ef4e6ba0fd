#include "engine/state/hashes.hpp"

#include <atomic>
#include <cstddef>

namespace troupe::engine {

std::uint64_t hash_rows(partition::Parallel& parallel, const StateTable& table, const RowRange& rows) {
  constexpr std::size_t k_block = 1024;  // rows per task
  std::atomic<std::uint64_t> sum = 0;
  parallel.for_batches(rows.end - rows.first, k_block, [&](std::size_t first, std::size_t end) {
    sum.fetch_add(table.hash_rows(rows.first + first, rows.first + end), std::memory_order_relaxed);
  });
  return sum;
}

}  // namespace troupe::engine
