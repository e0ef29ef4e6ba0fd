#include "engine/rows/rows.hpp"

#include "base/capacity.hpp"
#include "base/random.hpp"
#include "engine/fields/moved_rows.hpp"
#include "partition/message.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

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

/// Returns the bodies that have rows, in the order of their rows.
std::vector<BodyId> Rows::by_place(const partition::GridGeometry& geometry) const {
  struct Place {
    std::uint64_t key;
    BodyId body;
  };
  const auto low_bits = [](std::int32_t value, unsigned bits) {
    return static_cast<std::uint64_t>(value) & ((1u << bits) - 1);
  };
  std::vector<Place> places;
  places.reserve(state_.spec.bodies.size());
  for (std::size_t b = 0; b < state_.spec.bodies.size(); ++b) {
    const BodySpec& body = state_.spec.bodies[b];
    if (!state_.types[body.type.index()].runs()) continue;
    if (!state_.spec.starts(BodyId(b))) {  // the body is unborn: its row comes last
      places.push_back({~std::uint64_t{0}, BodyId(b)});
      continue;
    }
    const partition::Cell cell = geometry.cell(body.pose_world_body.position());
    std::uint64_t key = 0;
    const auto append = [&](partition::Cell c, unsigned bits) {
      key = (key << (2 * bits)) | (low_bits(c.y, bits) << bits) | low_bits(c.x, bits);
    };
    append(geometry.tile(cell), 24);
    append(geometry.block(cell), geometry.tile_bits - geometry.block_bits());
    append(cell, geometry.block_bits());
    places.push_back({key, BodyId(b)});
  }
  std::ranges::sort(places, {}, [](const Place& place) { return std::pair(place.key, place.body.value); });
  std::vector<BodyId> bodies;
  bodies.reserve(places.size());
  for (const Place& place : places) bodies.push_back(place.body);
  return bodies;
}

void Rows::build(const partition::GridGeometry& geometry) {
  state_.rows.resize(state_.spec.bodies.size());
  const std::vector<BodyId> bodies = by_place(geometry);
  const auto reserve = [&bodies](auto&... columns) { (columns.reserve(bodies.size()), ...); };
  reserve(state_.bodies, state_.ids, state_.row_types, state_.slots, state_.outline_begins);
  state_.pools.resize(state_.types.size());
  for (const BodyId body : bodies) ++state_.pools[state_.spec.bodies[body.index()].type.index()].rows;
  for (WorldState::Pool& pool : state_.pools) pool.slots = pool.rows;
  state_.place_pools();
  std::vector<std::uint32_t> slots(state_.types.size(), 0);
  for (const BodyId body : bodies) {
    const auto t = state_.spec.bodies[body.index()].type.value;
    state_.rows[body.index()] = Row(state_.bodies.size());
    state_.bodies.push_back(body);
    state_.ids.push_back(body.value);
    state_.row_types.push_back(t);
    state_.outline_begins.push_back(state_.outline_begin(t, slots[t]));
    state_.slots.push_back(slots[t]++);
  }
  state_.own_rows = state_.row_count();
  state_.subscribed.resize(state_.row_count());
  state_.radii.resize(state_.row_count());
  state_.shapes.resize(state_.row_count());
  state_.transforms.resize(state_.row_count());
  state_.bind_view();
}

void Rows::shuffle(std::uint64_t seed) {
  Random random(seed, stream_id("rows", "shuffle"), 0, static_cast<std::uint32_t>(state_.now.tick));
  std::vector<std::uint32_t> to(state_.row_count());
  std::iota(to.begin(), to.end(), 0u);
  random.shuffle(to);
  std::vector<std::vector<std::uint32_t>> slots_to(state_.types.size());
  for (const std::uint32_t t : state_.row_types)
    slots_to[t].push_back(static_cast<std::uint32_t>(slots_to[t].size()));
  for (std::vector<std::uint32_t>& slots : slots_to) random.shuffle(slots);
  move(to, slots_to);
}

/// Gives the body of each row r the row to[r], and the body of each slot s of type t the slot slots_to[t][s].
///
void Rows::move(std::span<const std::uint32_t> to, std::span<const std::vector<std::uint32_t>> slots_to) {
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
  for (std::size_t r = 0; r < state_.row_count(); ++r) {
    const std::uint32_t t = state_.row_types[r];
    state_.rows[state_.bodies[r].index()] = Row(r);
    state_.slots[r] = slots_to[t][state_.slots[r]];
    state_.outline_begins[r] = state_.outline_begin(t, state_.slots[r]);
  }
  for (PlacedRows* list : places_.placed_lists()) list->move_rows(to);
}

std::vector<RowState> Rows::take(std::span<const BodyId> bodies) {
  std::vector<bool> leaves(state_.row_count(), false);
  for (const BodyId body : bodies) {
    if (state_.view.location(body) != RowLocation::here || leaves[state_.view.row(body).index()])
      throw std::invalid_argument(fmt::format(
          "the row of \"{}\" cannot be removed: it is not in this world, or is to be removed twice",
          state_.spec.name(body)));
    leaves[state_.view.row(body).index()] = true;
  }
  for (std::size_t r = 0; state_.now.carried > 0 && r < state_.row_count(); ++r)
    if (leaves[r] != leaves[state_.roots[r]])
      throw std::invalid_argument(
          fmt::format("the row of \"{}\" cannot be removed without the rows of the bodies that carry it or "
                      "that it carries",
                      state_.spec.name(state_.bodies[leaves[r] ? r : state_.roots[r]])));
  std::vector<RowState> removed;
  for (const BodyId body : bodies) removed.push_back({body, bytes(state_.view.row(body))});
  drop(leaves);
  append({});
  state_.own_rows = state_.row_count();
  return removed;
}

void Rows::add(std::span<const RowState> added) {
  std::vector<bool> comes(state_.rows.size(), false);
  for (const RowState& each : added) {
    if (state_.view.location(each.body) != RowLocation::elsewhere || comes[each.body.index()])
      throw std::invalid_argument(
          fmt::format("the row of \"{}\" cannot be added: it is in this world already, it is to be added "
                      "twice, or the body is static",
                      state_.spec.name(each.body)));
    comes[each.body.index()] = true;
  }
  append(added);
  state_.own_rows = state_.row_count();
}

bool Rows::exchange(std::span<const BodyId> leaving, std::span<const RowState> coming, std::size_t own) {
  std::vector<bool> leaves(state_.row_count(), false);
  for (const BodyId body : leaving) leaves[state_.view.row(body).index()] = true;
  const bool is_change = !leaving.empty() || !coming.empty();
  if (!leaving.empty()) drop(leaves);
  if (is_change) append(coming);
  state_.own_rows = own;
  return is_change;
}

/// Removes each row r with leaves[r]. Rows in front of the first row that leaves, and their slots, do not
/// change. append() must follow.
void Rows::drop(const std::vector<bool>& leaves) {
  std::vector<std::uint32_t> to;
  const std::uint32_t kept = fill_gaps(leaves, to);
  std::vector<std::vector<bool>> slot_leaves(state_.types.size());
  for (const std::uint32_t t : state_.row_types) slot_leaves[t].push_back(false);
  for (std::uint32_t r = 0; r < state_.row_count(); ++r)
    slot_leaves[state_.row_types[r]][state_.slots[r]] = leaves[r];
  std::vector<std::vector<std::uint32_t>> slots_to(state_.types.size());
  std::vector<std::uint32_t> kept_slots(state_.types.size(), 0);
  for (std::size_t t = 0; t < state_.types.size(); ++t)
    kept_slots[t] = fill_gaps(slot_leaves[t], slots_to[t]);
  move(to, slots_to);

  for (std::size_t r = kept; r < state_.row_count(); ++r) state_.rows[state_.bodies[r].index()] = k_elsewhere;
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
  for (PlacedRows* list : places_.placed_lists()) list->keep_rows(kept);
}

/// Changes the capacity of all lists that have one element per row, and of the state tables, as
/// change_capacity() does for the present rows and the rows of `added` together. Returns, per table, whether
/// it has rows only for the bodies of one type.
std::vector<bool> Rows::change_capacities(std::span<const RowState> added) {
  std::vector<std::size_t> counts(state_.types.size(), 0);
  for (const std::uint32_t t : state_.row_types) ++counts[t];
  for (const RowState& each : added) ++counts[state_.spec.bodies[each.body.index()].type.index()];
  const std::size_t all = state_.row_count() + added.size();
  const auto change_all = [all](auto&... columns) { (change_capacity(columns, all), ...); };
  change_all(state_.bodies, state_.ids, state_.row_types, state_.slots, state_.outline_begins,
             state_.subscribed);
  std::vector<bool> is_of_type(state_.tables.size(), false);
  bool are_moved = false;
  for (std::size_t t = 0; t < state_.types.size(); ++t) {
    WorldState::Pool& pool = state_.pools[t];
    if (pool.rows == 0) continue;  // a type without rows has no tables
    for_tables_of_type(state_.types[t], [&](std::size_t table) {
      is_of_type[table] = true;
      state_.tables[table].change_capacity(counts[t]);
    });
    const std::size_t slots = capacity_for(counts[t], pool.slots);
    are_moved = are_moved || slots != pool.slots;
    pool.slots = slots;
  }
  for (std::size_t table = 0; table < state_.tables.size(); ++table)
    if (!is_of_type[table]) state_.tables[table].change_capacity(all);
  if (!are_moved) return is_of_type;
  state_.place_pools();
  for (std::size_t r = 0; r < state_.row_count(); ++r)
    state_.outline_begins[r] = state_.outline_begin(state_.row_types[r], state_.slots[r]);
  return is_of_type;
}

/// Adds rows after the present ones, in the order of the list. A RowState without bytes adds a row of zeros.
///
void Rows::append(std::span<const RowState> added) {
  const std::vector<bool> is_of_type = change_capacities(added);
  std::vector<std::uint32_t> counts(state_.types.size(), 0);
  for (const std::uint32_t t : state_.row_types) ++counts[t];
  for (const RowState& each : added) {
    const std::uint32_t t = state_.spec.bodies[each.body.index()].type.value;
    state_.rows[each.body.index()] = Row(state_.row_count());
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
    if (!each.bytes.empty()) set(state_.view.row(each.body), each.bytes);
}

/// The data of a row are all that are neither constant nor derived: whether its body is subscribed, what
/// blocked it if that is watched, the entries of the row in the lists of placed bodies (set_poses()), and the
/// row's data in the state tables.
std::vector<std::byte> Rows::bytes(Row row) {
  partition::MessageWriter message;
  const bool has_contact = !state_.contacts.empty();
  message.put(static_cast<std::uint8_t>(state_.subscribed[row.index()] + (has_contact ? 2 : 0)));
  if (has_contact) message.put(state_.contacts[row.index()]);
  for (const PlacedRows* list : places_.placed_lists()) {
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

/// Sets the data of a row from `bytes`, a result of bytes().
void Rows::set(Row row, std::span<const std::byte> bytes) {
  partition::MessageReader message(bytes);
  const auto flags = message.get<std::uint8_t>();
  state_.subscribed[row.index()] = flags & 1;
  const auto contact = (flags & 2) != 0 ? message.get<Contact>() : Contact();
  if (!state_.contacts.empty()) state_.contacts[row.index()] = contact;
  for (PlacedRows* list : places_.placed_lists())
    if (message.get<std::uint8_t>() != 0) list->set(row, message.get<Pose>());
  state_.for_tables_of(row, [&](std::size_t t, std::size_t at) {
    for (std::size_t f = 0; f < state_.tables[t].fields().size(); ++f)
      message.get_bytes(bytes_of(state_.tables[t], at, f));
  });
}

}  // namespace troupe::engine
