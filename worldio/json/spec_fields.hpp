#pragma once

#include "base/result.hpp"
#include "engine/description.hpp"
#include "engine/kinds.hpp"
#include "engine/spec_description.hpp"

#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>

// What code over the tables of a spec (engine/spec_description.hpp) has in common.

namespace troupe::worldio {

/// A value of a spec and how it was reached, from the inside out; it lives on the stack, and is spelt only
/// when something is reported.
struct SpecPath {
  const SpecPath* parent = nullptr;
  std::string_view name = {};  ///< of a member
  std::size_t index = 0;       ///< of an entry, where there is no name

  std::string text() const;  ///< `types[0].parts[2].size`
};

/// Key of a field in a stored world: its name and its SI unit, as in "period_s".
std::string key_of(const engine::Field& field);

/// Whether a number is finite and within the limits of a field.
inline bool is_within(const engine::Field& field, double x) {
  return std::isfinite(x) && x >= field.min && x <= field.max && !(field.above_min && x == field.min);
}

/// Whether a struct consists of numbers alone, as a pose does: a stored world has it as a list of these.
bool is_listed(const engine::FieldTable& table);
/// Numbers that a struct of numbers has, those of structs in it among them.
std::size_t numbers_in(const engine::FieldTable& table);

inline const void* member_of(const engine::Field& field, const void* object) {
  return static_cast<const char*>(object) + field.offset;
}
inline void* member_of(const engine::Field& field, void* object) {
  return static_cast<char*>(object) + field.offset;
}
/// The i-th block of a member that holds blocks or lists, to read.
inline const void* block_of(const engine::MemberType& type, const void* member, std::size_t i) {
  return type.block(const_cast<void*>(member), i);
}

/// Table of the parameters that a struct of a spec holds: of the kind that its member `kind` names, and of
/// the world's window. An error says which kinds there are.
Result<const engine::FieldTable*> parameters_of(const engine::FieldTable& table, const void* object,
                                                const engine::Registry& registry);

}  // namespace troupe::worldio
