#include "engine/state/batches.hpp"

#include "base/assert.hpp"

namespace troupe::engine {

void sort_by_type(const WorldState& state, std::span<Row> rows) {
  TROUPE_ASSERT(rows.size() <= k_row_block);
  const auto type_of = [&](Row row) { return state.row_types[row.index()]; };
  std::uint32_t last_type = 0;
  for (const Row row : rows) last_type = std::max(last_type, type_of(row));

  // A radix sort: one stable counting sort for each byte of the types. Few worlds have more than 256 types.
  constexpr unsigned k_digit_bits = 8;
  constexpr std::uint32_t k_last_digit = (1u << k_digit_bits) - 1;
  for (unsigned shift = 0; shift < 32 && last_type >> shift != 0; shift += k_digit_bits) {
    const auto digit_of = [&](Row row) { return (type_of(row) >> shift) & k_last_digit; };
    std::array<std::uint32_t, k_last_digit + 1> places{};  // of the next row with each digit
    for (const Row row : rows) ++places[digit_of(row)];
    std::uint32_t before = 0;
    for (std::uint32_t& place : places) before += std::exchange(place, before);
    std::array<Row, k_row_block> sorted;
    for (const Row row : rows) sorted[places[digit_of(row)]++] = row;
    std::copy_n(sorted.begin(), rows.size(), rows.begin());
  }
}

}  // namespace troupe::engine
