#pragma once

#include "engine/world/world.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace troupe::engine {

/// One value of the state of a world: its type and its bits. The state is a list of tables. Each table holds
/// one component, such as the poses, with one row per body. A row has fields, and a field has one or more
/// columns, each with one value.
struct StateValue {
  Element element = Element::f64;  ///< type of the value
  std::uint64_t bits = 0;          ///< bits of the value, in the low bytes; the other bits are 0
};
/// Text of a value: its bits as a hexadecimal number, and the value in parentheses, such as
/// `0x3fe0000000000000 (0.5)`. Values with different bits have different texts.
std::string value_text(const StateValue& value);

/// Name of the column with this index, from 0: `turn`, or `ranges[4]` if the field has several columns.
std::string field_text(const StateField& field, std::size_t column);

/// A callback of compare_rows() for a value that differs between two rows. Its arguments: the field, the
/// index of the column in the field, the value in the first row, and the value in the second row.
using ReportValue =
    std::function<void(const StateField&, std::size_t column, const StateValue&, const StateValue&)>;
/// Calls `report` for each value that differs between two rows, in the order of the fields. The values are
/// compared bit by bit: -0 differs from 0, and a NaN equals a NaN with the same bits. `first` and `second`
/// point to the first byte of each row (StateTable::row()). In both rows, each field begins at the byte
/// StateField::offset. Bytes between the fields are ignored.
void compare_rows(std::span<const StateField> fields, const std::byte* first, const std::byte* second,
                  const ReportValue& report);

/// Difference between two states of one world in one component (one table of the state).
struct ComponentDifference {
  /// Name of the component (StateTable::component()). If the two worlds have different numbers of tables,
  /// this is `the list of components`, and state_differences() returns no other difference.
  std::string component;
  /// Hash group of the component: components of one group are hashed together. It has no meaning for `the
  /// list of components`.
  HashGroup group = HashGroup::pose;
  /// Number of bodies whose rows differ. If it is 0, the component has different bodies or different fields
  /// in the two worlds, and the following members have no meaning.
  std::size_t bodies = 0;
  BodyId body;        ///< lowest id of a body whose row differs
  std::string field;  ///< name of the first column that differs in the row of that body: field_text()
  StateValue first;   ///< value of that column in the first world
  StateValue second;  ///< value of that column in the second world
};

/// Compares the states of two worlds that were made from one file. Returns one entry for each component that
/// differs; an empty list if the states are equal.
///
/// A difference in readings spreads to memories, then to commands, then to poses. The entries are sorted in
/// this order, by hash group: sensors, memories, velocities and commands, poses. The first entries are thus
/// nearest to the cause. Rows are matched by the ids of their bodies, so their order may differ. Components
/// with equal hashes are assumed to be equal, and their values are not compared. Throws std::logic_error if
/// the last step of a world threw (World::require_whole()).
std::vector<ComponentDifference> state_differences(World& first, World& second);

/// Returns the message for a difference, with the names that bodies have in `world`. For example:
/// `ranger/eye: ranges[4] of "r12" (id 13) is 0x3f800001 (1.0000001), not 0x3f800000 (1); 3 bodies differ`.
/// The value after "is" is that of the second world, the value after "not" that of the first world. If
/// ComponentDifference::bodies is 0, the message is `ranger/eye: the states have different bodies or fields`.
std::string difference_text(const World& world, const ComponentDifference& difference);

}  // namespace troupe::engine
