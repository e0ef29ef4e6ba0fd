#pragma once

#include "engine/fields/state_table.hpp"
#include "engine/state/world_state.hpp"
#include "partition/parallel.hpp"

#include <array>
#include <cstdint>

namespace troupe::engine {

/// The hashes of a state (docs/determinism.md): one for all state tables together, and one for each group of
/// tables. They do not depend on the order of the rows. All sums are modulo 2^64.
struct Hashes {
  std::uint64_t state = 0;                            ///< sum of the hashes of all tables
  std::array<std::uint64_t, k_hash_groups> groups{};  ///< one per HashGroup: sum of the hashes of its tables
};

/// Returns the sum of the hashes of rows of a table, modulo 2^64. Uses all threads of `parallel`.
std::uint64_t hash_rows(partition::Parallel& parallel, const StateTable& table, const RowRange& rows);

}  // namespace troupe::engine
