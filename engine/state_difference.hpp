#pragma once

#include "engine/world.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace troupe::engine {

/// One value of the state: its bits, in the low bytes, and how to read them.
struct StateValue {
  Element element = Element::f64;  ///< says which of the bytes count
  std::uint64_t bits = 0;          ///< of the value; above its size 0
};
/// Bits and value, `0x3fe0000000000000 (0.5)`: two values that differ never look the same.
std::string value_text(const StateValue& value);

/// `turn`, or `ranges[4]` of a field of several columns.
std::string field_text(const StateField& field, std::size_t column);

/// Is told of a value that differs: its field and column, what the first row has there, and the second.
using ReportValue =
    std::function<void(const StateField&, std::size_t column, const StateValue&, const StateValue&)>;
/// Calls `report` for each value in which two packed rows differ, in the order of the fields; bits are
/// compared, so that -0 differs from 0 and a NaN equals itself. Fields lie at their offsets; what lies
/// between them is not looked at.
void compare_rows(std::span<const StateField> fields, const std::byte* first, const std::byte* second,
                  const ReportValue& report);

/// How two states of one world differ in one component.
struct ComponentDifference {
  std::string component;              ///< StateTable::component()
  HashGroup group = HashGroup::pose;  ///< that it adds to
  std::size_t entities = 0;           ///< that differ; 0: the component has other entities or fields in each
  BodyId body;                        ///< the lowest of them, and its first value that differs:
  std::string field;                  ///< of the first field that differs, with its column: field_text()
  StateValue first;                   ///< what the first world has there
  StateValue second;                  ///< what the second has
};

/// Every component in which two worlds that were made from one file differ, in the order in which a tick
/// makes them: sensors, memories, commands and velocities, poses. Empty when the states are the same.
/// cost    components whose hashes agree are taken as equal; only the others are read value by value
/// order   entities are matched by id: rows may lie anyhow in either world
std::vector<ComponentDifference> state_differences(World& first, World& second);

/// `ranger/eye: ranges[4] of "r12" (id 13) is 0x3f800001 (1.0000001), not 0x3f800000 (1); 3 entities differ`:
/// the second state's value stands first.
std::string difference_text(const World& world, const ComponentDifference& difference);

}  // namespace troupe::engine
