#include "engine/ranks/rank_rows.hpp"

#include "engine/world/world.hpp"

#include <algorithm>
#include <cstddef>

namespace troupe::engine {

RowRange rows_in(const World& world, const StateTable& table, const RowRange& rows) {
  if (table.rows() == world.view().rows()) return rows;
  const auto before = [&](std::size_t row) {
    const auto found = std::ranges::partition_point(
        table.ids(), [&](BodyId body) { return world.view().row(body).index() < row; });
    return static_cast<std::size_t>(found - table.ids().begin());
  };
  return {before(rows.first), before(rows.end)};
}

Effect get_effect(partition::MessageReader& message, const World& world) {
  const auto effect = message.get<Effect>();
  const WorldSpec& spec = world.spec();
  message.require(effect.source.index() < spec.bodies.size());
  message.require(effect.device < world.view().type(effect.source).devices.size());
  message.require(!effect.target.valid() || effect.target.index() < spec.bodies.size());
  message.require(effect.verb != k_birth || effect.reserve < spec.reserves.size());
  return effect;
}

}  // namespace troupe::engine
