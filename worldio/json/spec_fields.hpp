#pragma once

#include "base/result.hpp"
#include "engine/description.hpp"
#include "engine/kinds.hpp"
#include "engine/spec_description.hpp"

#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>

// Shared by the code that walks the tables of a spec (engine/spec_description.hpp).

namespace troupe::worldio {

/// Path to a value of a spec, linked from the value to the root. Paths live on the stack and are formatted
/// only for an error.
struct SpecPath {
  const SpecPath* parent = nullptr;
  std::string_view name = {};  ///< of a member; empty for an entry of a list
  std::size_t index = 0;       ///< of an entry of a list

  std::string text() const;  ///< `types[0].parts[2].size`
};

/// Key of a field in a stored world: its name and its SI unit, "period_s".
std::string key_of(const engine::Field& field);

/// Whether a number is finite and within a field's limits.
inline bool is_within(const engine::Field& field, double x) {
  return std::isfinite(x) && x >= field.min && x <= field.max && !(field.above_min && x == field.min);
}

/// Whether a struct consists only of numbers, as a pose does. Stored worlds have it as a list of numbers.
bool is_listed(const engine::FieldTable& table);
/// How many numbers such a struct has, including those of nested structs.
std::size_t numbers_in(const engine::FieldTable& table);

inline const void* member_of(const engine::Field& field, const void* object) {
  return static_cast<const char*>(object) + field.offset;
}
inline void* member_of(const engine::Field& field, void* object) {
  return static_cast<char*>(object) + field.offset;
}
/// The i-th block of a member that holds blocks or lists; read-only.
inline const void* block_of(const engine::MemberType& type, const void* member, std::size_t i) {
  return type.block(const_cast<void*>(member), i);
}

/// The table of the parameters in a struct of a spec: those of the kind named by its member `kind`, or, for
/// the world, those of its window. The error lists the known kinds.
Result<const engine::FieldTable*> parameters_of(const engine::FieldTable& table, const void* object,
                                                const engine::Registry& registry);

}  // namespace troupe::worldio
