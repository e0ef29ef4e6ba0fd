#include "base/fp_environment.hpp"
#include "base/random.hpp"
#include "engine/world.hpp"

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <stdexcept>
#include <vector>

// The test mode in which bodies change their rows.

namespace troupe::engine {
namespace {

/// Moves each element i of a column to the place to[i]. An empty column stays empty.
template <class T>
void move_elements(std::vector<T>& column, std::span<const std::uint32_t> to) {
  const std::vector<T> old = column;
  for (std::size_t i = 0; i < old.size(); ++i) column[to[i]] = old[i];
}

/// Calls visit(t) for each state table t that has rows only for bodies of this type.
template <class Visit>
void for_tables_of_type(const BodyType& type, Visit&& visit) {
  for (const BodyType::Joint& joint : type.joints) visit(joint.table);
  if (type.drive && type.drive->odometry_table) visit(*type.drive->odometry_table);
  for (const BodyType::Device& device : type.devices) {
    visit(device.table);
    if (device.command_table) visit(*device.command_table);
  }
  for (const BodyType::Controller& controller : type.controllers)
    if (controller.table) visit(*controller.table);
}

}  // namespace

void World::shuffle_rows(std::uint64_t seed) {
  require_whole();
  if (replica_ != nullptr)
    throw std::logic_error("the rows of a world that several ranks compute cannot be shuffled");
  restore_fp_environment();  // a library may have changed it, see step()
  const Completion completion(*this);
  Random random(seed, stream_id("rows", "shuffle"), 0, static_cast<std::uint32_t>(state_.now.tick));
  std::vector<std::uint32_t> to(rows());  // the new row of each row
  std::iota(to.begin(), to.end(), 0u);
  random.shuffle(to);
  std::vector<std::vector<std::uint32_t>> slots_to(
      state_.types.size());  // by type: the new slot of each slot
  for (const std::uint32_t t : state_.row_types)
    slots_to[t].push_back(static_cast<std::uint32_t>(slots_to[t].size()));
  for (std::vector<std::uint32_t>& slots : slots_to) random.shuffle(slots);

  std::vector<bool> is_of_type(state_.tables.size(), false);
  for (std::size_t t = 0; t < state_.types.size(); ++t) {
    if (slots_to[t].empty()) continue;  // such a type has no tables
    for_tables_of_type(state_.types[t], [&](std::size_t table) {
      is_of_type[table] = true;
      state_.tables[table].move_rows(slots_to[t]);
    });
  }
  for (std::size_t table = 0; table < state_.tables.size(); ++table)
    if (!is_of_type[table]) state_.tables[table].move_rows(to);

  move_elements(state_.bodies, to);
  move_elements(state_.ids, to);
  move_elements(state_.row_types, to);
  move_elements(state_.slots, to);
  move_elements(state_.subscribed, to);
  for (std::size_t r = 0; r < rows(); ++r) {
    const std::uint32_t t = state_.row_types[r];
    state_.rows[state_.bodies[r].index()] = Row(r);
    const std::uint32_t slot = slots_to[t][state_.slots[r]];
    state_.slots[r] = slot;
    state_.outline_begins[r] = state_.outline_begin(t, slot);
    if (!state_.joint_begins.empty()) state_.joint_begins[r] = state_.joint_begin(t, slot);
  }
  movement_.move_rows(to);
  links_.move_rows(to);
  for (std::vector<Placed>* list : {&placed_, &placed_before_})
    for (Placed& placed : *list) placed.row = Row(to[placed.row.index()]);
  move_elements(placed_at_, to);

  // Derives again what depends on rows. derive_state() would also clear the lists of placed bodies.
  movement_.draw_odometry_errors();
  links_.derive();
  for (std::size_t r = 0; r < rows(); ++r) derive(Row(r));
  if (state_.ray_grid) {
    Diagnostics diagnostics(state_.spec.files);  // stays empty: the constructor has made the same checks
    build_ray_grid(diagnostics);
  }
  index_bodies();
}

}  // namespace troupe::engine
