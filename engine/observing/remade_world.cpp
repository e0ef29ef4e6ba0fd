#include "engine/observing/remade_world.hpp"

#include "base/diagnostics.hpp"

#include <cstring>
#include <stdexcept>
#include <vector>

namespace troupe::engine {
namespace {

/// Copies the table `from` of `world` to the table `to` of another world, which has the same layout. Copies
/// body by body, because the rows of a body in the two tables may differ, and field by field, because the
/// bytes between fields are not state.
void copy_fields(const World& world, const StateTable& from, StateTable& to) {
  std::vector<std::size_t> rows;  // rows in `from`, one for each body of `to`
  for (const BodyId body : to.ids()) rows.push_back(world.view().row_in(from, world.view().row(body)));
  for (std::size_t f = 0; f < from.fields().size(); ++f) {
    const std::size_t bytes = from.fields()[f].bytes();
    for (std::size_t r = 0; r < rows.size(); ++r)
      std::memcpy(to.cell<std::byte>(r, f).data(), from.cell<std::byte>(rows[r], f).data(), bytes);
  }
}

}  // namespace

std::unique_ptr<World> remade_world(World& world, const Registry& registry, const WorldOptions& options) {
  Diagnostics overlaps;  // warnings about overlaps, not shown because `world` has already reported them
  auto other = std::make_unique<World>(world.spec(), registry, options, overlaps);
  for (const BodyId body : world.view().subscribed()) other->subscribe(body);
  const auto fill = [&world](std::span<StateTable> tables) {
    for (std::size_t t = 0; t < tables.size(); ++t) copy_fields(world, world.tables()[t], tables[t]);
  };
  if (!other->restore(world.tick(), world.counters(), world.hashes().state, fill))
    throw std::logic_error(
        "internal error: the copied tables of a world have another hash; this is no error of your input: "
        "please report it");
  return other;
}

}  // namespace troupe::engine
