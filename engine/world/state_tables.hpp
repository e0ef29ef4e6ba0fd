#pragma once

#include "engine/fields/state_table.hpp"
#include "engine/state/world_state.hpp"

#include <span>
#include <vector>

namespace troupe::engine {

/// Adds the tables that every world has, in the order of WorldState::TableIndex, and the component `carrier`
/// if bodies can carry others.
void add_common_tables(WorldState& state);
/// Adds the component `contact`, if the world or a controller wants it.
void add_contact_table(WorldState& state);
/// Adds the tables of all types that have rows: those of their joints, odometry, devices and controllers.
void add_tables_of_types(WorldState& state);
/// Returns the tables, without rows, that types without bodies would add. Their names and fields are valid in
/// the world although no body has them, for example because an option such as --robots has removed all bodies
/// of the type.
std::vector<StateTable> unused_tables(const WorldState& state);

}  // namespace troupe::engine
