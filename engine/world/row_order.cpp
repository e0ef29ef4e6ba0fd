#include "base/fp_environment.hpp"
#include "base/random.hpp"
#include "base/room.hpp"
#include "engine/fields/moved_rows.hpp"
#include "engine/state/blinkers.hpp"
#include "engine/world/world.hpp"
#include "partition/message.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

// Functions of World that give bodies other rows, remove rows from a world, and add rows to it.

namespace troupe::engine {
namespace {

/// For a list whose elements i with leaves[i] are to be removed: sets to[i] to a new place for each element
/// i, such that the elements that leave come last. Of the other elements, only those that fill the gaps
/// change their places. Returns the number of the other elements.
std::uint32_t fill_gaps(const std::vector<bool>& leaves, std::vector<std::uint32_t>& to) {
  to.resize(leaves.size());
  std::iota(to.begin(), to.end(), 0u);
  const auto kept = static_cast<std::uint32_t>(std::ranges::count(leaves, false));
  std::uint32_t gap = 0;
  for (std::uint32_t i = kept; i < leaves.size(); ++i) {
    if (leaves[i]) continue;
    while (!leaves[gap]) ++gap;
    to[i] = gap;
    to[gap++] = i;
  }
  return kept;
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

/// The bytes of a field in a row of a table.
std::span<std::byte> bytes_of(StateTable& table, std::size_t row, std::size_t field) {
  return {table.cell<std::byte>(row, field).data(), table.fields()[field].bytes()};
}

}  // namespace

/// Public functions that change which rows bodies have call this first. Throws std::logic_error if several
/// ranks compute the world. `what` names the change in the error text, for example `shuffled`.
void World::begin_row_change(std::string_view what) const {
  require_whole();
  if (replica_ != nullptr)
    throw std::logic_error(fmt::format("the rows of a world that several ranks compute cannot be {}", what));
  restore_fp_environment();  // a library may have changed it: see step()
}

void World::shuffle_rows(std::uint64_t seed) {
  begin_row_change("shuffled");
  const Completion completion(*this);
  Random random(seed, stream_id("rows", "shuffle"), 0, static_cast<std::uint32_t>(state_.now.tick));
  std::vector<std::uint32_t> to(rows());
  std::iota(to.begin(), to.end(), 0u);
  random.shuffle(to);
  std::vector<std::vector<std::uint32_t>> slots_to(state_.types.size());
  for (const std::uint32_t t : state_.row_types)
    slots_to[t].push_back(static_cast<std::uint32_t>(slots_to[t].size()));
  for (std::vector<std::uint32_t>& slots : slots_to) random.shuffle(slots);
  move_rows(to, slots_to);
  derive_rows();
}

/// Gives the body of each row r the row to[r], and the body of each slot s of type t the slot slots_to[t][s].
/// derive_rows() must follow.
void World::move_rows(std::span<const std::uint32_t> to,
                      std::span<const std::vector<std::uint32_t>> slots_to) {
  std::vector<bool> is_of_type(state_.tables.size(), false);
  for (std::size_t t = 0; t < state_.types.size(); ++t) {
    if (state_.pools[t].rows == 0) continue;  // a type without rows has no tables
    for_tables_of_type(state_.types[t], [&](std::size_t table) {
      is_of_type[table] = true;
      state_.tables[table].move_rows(slots_to[t]);
    });
  }
  for (std::size_t table = 0; table < state_.tables.size(); ++table)
    if (!is_of_type[table]) state_.tables[table].move_rows(to);
  const std::vector<std::uint32_t> moved = moved_places(to);
  move_elements(state_.bodies, moved, to);
  move_elements(state_.ids, moved, to);
  move_elements(state_.row_types, moved, to);
  move_elements(state_.slots, moved, to);
  move_elements(state_.subscribed, moved, to);
  move_elements(state_.contacts, moved, to);
  for (std::size_t r = 0; r < rows(); ++r) {
    const std::uint32_t t = state_.row_types[r];
    state_.rows[state_.bodies[r].index()] = Row(r);
    state_.slots[r] = slots_to[t][state_.slots[r]];
    state_.outline_begins[r] = state_.outline_begin(t, state_.slots[r]);
  }
  for (PlacedRows* list : {&placed_, &placed_before_}) list->move_rows(to);
}

/// Called after bodies have got other rows, and after rows were removed or added: computes all data that
/// depend on the rows. Does not call derive_state(), which would also clear the lists of the bodies that
/// set_poses() has placed (placed_before_step()).
void World::derive_rows() {
  resize_with_room(state_.radii, rows());
  resize_with_room(state_.shapes, rows());
  resize_with_room(state_.transforms, rows());
  if (!state_.not_drawn.empty()) resize_with_room(state_.not_drawn, rows());
  movement_.build();
  links_.build();
  state_.bind_view();
  movement_.draw_odometry_errors();
  count_present();
  count_impaired();
  movement_.count_stalls();
  links_.derive();
  for (std::size_t r = 0; r < rows(); ++r) derive(Row(r));
  if (state_.ray_grid) {
    Diagnostics diagnostics(state_.spec.files);  // stays empty: the constructor has made the same checks
    build_ray_grid(diagnostics);
  }
  if (blinkers_) blinkers_.reset(new Blinkers(state_));
  index_bodies();
}

std::vector<World::RowState> World::remove_rows(std::span<const BodyId> bodies) {
  begin_row_change("removed");
  std::vector<bool> leaves(rows(), false);
  for (const BodyId body : bodies) {
    if (location(body) != RowLocation::here || leaves[row(body).index()])
      throw std::invalid_argument(fmt::format(
          "the row of \"{}\" cannot be removed: it is not in this world, or is to be removed twice",
          state_.spec.name(body)));
    leaves[row(body).index()] = true;
  }
  for (std::size_t r = 0; state_.now.carried > 0 && r < rows(); ++r)
    if (leaves[r] != leaves[state_.roots[r]])
      throw std::invalid_argument(
          fmt::format("the row of \"{}\" cannot be removed without the rows of the bodies that carry it or "
                      "that it carries",
                      state_.spec.name(state_.bodies[leaves[r] ? r : state_.roots[r]])));
  const Completion completion(*this);
  std::vector<RowState> removed;
  for (const BodyId body : bodies) removed.push_back({body, row_bytes(row(body))});
  drop_rows(leaves);
  append_rows({});
  state_.own_rows = rows();
  derive_rows();
  return removed;
}

void World::add_rows(std::span<const RowState> added) {
  begin_row_change("added");
  std::vector<bool> comes(state_.rows.size(), false);
  for (const RowState& each : added) {
    if (location(each.body) != RowLocation::elsewhere || comes[each.body.index()])
      throw std::invalid_argument(
          fmt::format("the row of \"{}\" cannot be added: it is in this world already, it is to be added "
                      "twice, or the body is static",
                      state_.spec.name(each.body)));
    comes[each.body.index()] = true;
  }
  const Completion completion(*this);
  append_rows(added);
  state_.own_rows = rows();
  derive_rows();
}

void World::exchange_rows(std::span<const BodyId> leaving, std::span<const RowState> coming,
                          std::size_t own) {
  std::vector<bool> leaves(rows(), false);
  for (const BodyId body : leaving) leaves[row(body).index()] = true;
  if (!leaving.empty()) drop_rows(leaves);
  if (!leaving.empty() || !coming.empty()) append_rows(coming);
  state_.own_rows = own;
  if (!leaving.empty() || !coming.empty())
    derive_rows();
  else
    movement_.count_stalls();
}

/// Removes each row r with leaves[r]. Rows in front of the first row that leaves, and their slots, do not
/// change. append_rows() and derive_rows() must follow.
void World::drop_rows(const std::vector<bool>& leaves) {
  std::vector<std::uint32_t> to;
  const std::uint32_t kept = fill_gaps(leaves, to);
  std::vector<std::vector<bool>> slot_leaves(state_.types.size());
  for (const std::uint32_t t : state_.row_types) slot_leaves[t].push_back(false);
  for (std::uint32_t r = 0; r < rows(); ++r) slot_leaves[state_.row_types[r]][state_.slots[r]] = leaves[r];
  std::vector<std::vector<std::uint32_t>> slots_to(state_.types.size());
  std::vector<std::uint32_t> kept_slots(state_.types.size(), 0);
  for (std::size_t t = 0; t < state_.types.size(); ++t)
    kept_slots[t] = fill_gaps(slot_leaves[t], slots_to[t]);
  move_rows(to, slots_to);

  for (std::size_t r = kept; r < rows(); ++r) state_.rows[state_.bodies[r].index()] = k_elsewhere;
  state_.bodies.resize(kept);
  state_.ids.resize(kept);
  state_.row_types.resize(kept);
  state_.slots.resize(kept);
  state_.outline_begins.resize(kept);
  state_.subscribed.resize(kept);
  if (!state_.contacts.empty()) state_.contacts.resize(kept);
  std::vector<std::size_t> counts(state_.tables.size(), kept);
  for (std::size_t t = 0; t < state_.types.size(); ++t)
    if (state_.pools[t].rows > 0)
      for_tables_of_type(state_.types[t], [&](std::size_t table) { counts[table] = kept_slots[t]; });
  for (std::size_t table = 0; table < counts.size(); ++table) state_.tables[table].keep_rows(counts[table]);
  for (PlacedRows* list : {&placed_, &placed_before_}) list->keep_rows(kept);
}

/// Changes the capacity of all lists that have one element per row, and of the state tables, as make_room()
/// does for the present rows and the rows of `added` together. Returns, per table, whether it has rows only
/// for the bodies of one type.
std::vector<bool> World::make_room_for(std::span<const RowState> added) {
  std::vector<std::size_t> counts(state_.types.size(), 0);
  for (const std::uint32_t t : state_.row_types) ++counts[t];
  for (const RowState& each : added) ++counts[state_.spec.bodies[each.body.index()].type.index()];
  const std::size_t all = rows() + added.size();
  const auto make_room_in = [all](auto&... columns) { (make_room(columns, all), ...); };
  make_room_in(state_.bodies, state_.ids, state_.row_types, state_.slots, state_.outline_begins,
               state_.subscribed);
  std::vector<bool> is_of_type(state_.tables.size(), false);
  bool are_moved = false;
  for (std::size_t t = 0; t < state_.types.size(); ++t) {
    WorldState::Pool& pool = state_.pools[t];
    if (pool.rows == 0) continue;  // a type without rows has no tables
    for_tables_of_type(state_.types[t], [&](std::size_t table) {
      is_of_type[table] = true;
      state_.tables[table].make_room(counts[t]);
    });
    const std::size_t slots = room_for(counts[t], pool.slots);
    are_moved = are_moved || slots != pool.slots;
    pool.slots = slots;
  }
  for (std::size_t table = 0; table < state_.tables.size(); ++table)
    if (!is_of_type[table]) state_.tables[table].make_room(all);
  if (!are_moved) return is_of_type;
  state_.place_pools();
  for (std::size_t r = 0; r < rows(); ++r)
    state_.outline_begins[r] = state_.outline_begin(state_.row_types[r], state_.slots[r]);
  return is_of_type;
}

/// Adds rows after the present ones, in the order of the list. A RowState without bytes adds a row of zeros.
/// derive_rows() must follow.
void World::append_rows(std::span<const RowState> added) {
  const std::vector<bool> is_of_type = make_room_for(added);
  std::vector<std::uint32_t> counts(state_.types.size(), 0);
  for (const std::uint32_t t : state_.row_types) ++counts[t];
  for (const RowState& each : added) {
    const std::uint32_t t = state_.spec.bodies[each.body.index()].type.value;
    state_.rows[each.body.index()] = Row(rows());
    state_.bodies.push_back(each.body);
    state_.ids.push_back(each.body.value);
    state_.row_types.push_back(t);
    state_.slots.push_back(counts[t]++);
    state_.outline_begins.push_back(state_.outline_begin(t, state_.slots.back()));
    state_.subscribed.push_back(0);
    if (state_.watches_contacts && !state_.contact_table) state_.contacts.emplace_back();
    for (std::size_t table = 0; table < state_.tables.size(); ++table)
      if (!is_of_type[table]) state_.tables[table].add_rows({&each.body, 1});
    for_tables_of_type(state_.types[t], [&](std::size_t table) {
      state_.tables[table].add_rows({&each.body, 1});
    });
  }
  state_.bind_view();
  for (const RowState& each : added)
    if (!each.bytes.empty()) set_state(row(each.body), each.bytes);
}

/// Returns all data of a row that are neither constant nor derived: whether its body is subscribed, what
/// blocked it if that is watched, the entries of the row in the lists of placed bodies (set_poses()), and the
/// row's data in the state tables.
std::vector<std::byte> World::row_bytes(Row row) {
  partition::MessageWriter message;
  const bool has_contact = !state_.contacts.empty();
  message.put(static_cast<std::uint8_t>(state_.subscribed[row.index()] + (has_contact ? 2 : 0)));
  if (has_contact) message.put(state_.contacts[row.index()]);
  for (const PlacedRows* list : {&placed_, &placed_before_}) {
    const Pose* const pose = list->find(row);
    message.put(static_cast<std::uint8_t>(pose != nullptr));
    if (pose != nullptr) message.put(*pose);
  }
  state_.for_tables_of(row, [&](std::size_t t, std::size_t at) {
    for (std::size_t f = 0; f < state_.tables[t].fields().size(); ++f)
      message.put_bytes(bytes_of(state_.tables[t], at, f));
  });
  return message.take();
}

/// Sets the data of a row from `bytes`, a result of row_bytes().
void World::set_state(Row row, std::span<const std::byte> bytes) {
  partition::MessageReader message(bytes);
  const auto flags = message.get<std::uint8_t>();
  state_.subscribed[row.index()] = flags & 1;
  const auto contact = (flags & 2) != 0 ? message.get<Contact>() : Contact();
  if (!state_.contacts.empty()) state_.contacts[row.index()] = contact;
  for (PlacedRows* list : {&placed_, &placed_before_})
    if (message.get<std::uint8_t>() != 0) list->set(row, message.get<Pose>());
  state_.for_tables_of(row, [&](std::size_t t, std::size_t at) {
    for (std::size_t f = 0; f < state_.tables[t].fields().size(); ++f)
      message.get_bytes(bytes_of(state_.tables[t], at, f));
  });
}

}  // namespace troupe::engine
