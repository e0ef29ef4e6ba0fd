#include "engine/state/batches.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

namespace troupe::engine::batches_test {
namespace {

// Few types, so that many rows share one, types that differ only in their upper bytes, and any others.
rc::Gen<std::uint32_t> some_type() {
  return rc::gen::oneOf(rc::gen::inRange(0u, 3u), rc::gen::element(0x100u, 0x10000u, 0x1000000u, 0x1010101u),
                        rc::gen::inRange(0u, std::numeric_limits<std::uint32_t>::max()));
}

RC_GTEST_PROP(Batches, RowsAreSortedByTypeAndRowsOfOneTypeKeepTheirOrder, ()) {
  WorldState state;
  const auto count = *rc::gen::inRange<std::size_t>(0, k_row_block + 1);
  state.row_types = *rc::gen::container<std::vector<std::uint32_t>>(count, some_type());
  std::vector<Row> rows;
  for (std::size_t i = 0; i < count; ++i) rows.push_back(Row(count - 1 - i));
  std::vector<Row> expected = rows;
  std::ranges::stable_sort(expected, {}, [&](Row row) { return state.row_types[row.index()]; });
  sort_by_type(state, rows);
  RC_ASSERT(rows == expected);
}

}  // namespace
}  // namespace troupe::engine::batches_test
