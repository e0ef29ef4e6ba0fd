#pragma once

#include "engine/world.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace troupe::engine {

/// One value of the state: its bits, in the low bytes, and its type.
struct StateValue {
  Element element = Element::f64;  ///< type of the value
  std::uint64_t bits = 0;          ///< bits of the value; higher bits are 0
};
/// Bits and value, as in `0x3fe0000000000000 (0.5)`, so that different values always have different texts.
std::string value_text(const StateValue& value);

/// Name of a column: `turn`, or `ranges[4]` if the field has several columns.
std::string field_text(const StateField& field, std::size_t column);

/// Called for a value that differs, with its field and column and the values of the first and second row.
using ReportValue =
    std::function<void(const StateField&, std::size_t column, const StateValue&, const StateValue&)>;
/// Calls `report` for each value that differs between two packed rows, in the order of the fields. Compares
/// bits: -0 differs from 0, and a NaN equals itself. Fields are at their offsets; bytes between them are
/// ignored.
void compare_rows(std::span<const StateField> fields, const std::byte* first, const std::byte* second,
                  const ReportValue& report);

/// Difference between two states of one world in one component.
struct ComponentDifference {
  std::string component;              ///< StateTable::component()
  HashGroup group = HashGroup::pose;  ///< hash group of the component
  std::size_t entities = 0;  ///< number that differ; 0: the entities or fields of the component differ
  BodyId body;               ///< lowest id of an entity that differs
  std::string field;         ///< its first value that differs, see field_text()
  StateValue first;          ///< value in the first world
  StateValue second;         ///< value in the second world
};

/// Components that differ between two worlds made from one file, in the order in which a tick computes them:
/// sensors, memories, commands and velocities, poses. Empty if the states are equal.
/// cost    components with equal hashes are taken as equal; only the others are compared value by value
/// order   entities are matched by id, so the order of the rows may differ
std::vector<ComponentDifference> state_differences(World& first, World& second);

/// `ranger/eye: ranges[4] of "r12" (id 13) is 0x3f800001 (1.0000001), not 0x3f800000 (1); 3 entities differ`.
/// The first value is that of the second state.
std::string difference_text(const World& world, const ComponentDifference& difference);

}  // namespace troupe::engine
