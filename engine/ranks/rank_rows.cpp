#include "engine/ranks/rank_rows.hpp"

#include "engine/world/world.hpp"

#include <algorithm>
#include <atomic>
#include <cstddef>

namespace troupe::engine {

RowRange rows_in(const World& world, const StateTable& table, const RowRange& rows) {
  if (table.rows() == world.rows()) return rows;
  const auto before = [&](std::size_t row) {
    const auto found =
        std::ranges::partition_point(table.ids(), [&](BodyId body) { return world.row(body).index() < row; });
    return static_cast<std::size_t>(found - table.ids().begin());
  };
  return {before(rows.first), before(rows.end)};
}

std::uint64_t hash_of(partition::Parallel& parallel, const StateTable& table, const RowRange& rows) {
  constexpr std::size_t k_block = 1024;  // rows per task
  std::atomic<std::uint64_t> sum = 0;
  parallel.for_batches(rows.end - rows.first, k_block, [&](std::size_t first, std::size_t end) {
    sum.fetch_add(table.hash_rows(rows.first + first, rows.first + end), std::memory_order_relaxed);
  });
  return sum;
}

Effect get_effect(partition::MessageReader& message, const World& world) {
  const auto effect = message.get<Effect>();
  const WorldSpec& spec = world.spec();
  message.require(effect.source.index() < spec.bodies.size());
  message.require(effect.device < world.type(effect.source).devices.size());
  message.require(!effect.target.valid() || effect.target.index() < spec.bodies.size());
  message.require(effect.verb != k_birth || effect.reserve < spec.reserves.size());
  return effect;
}

}  // namespace troupe::engine
