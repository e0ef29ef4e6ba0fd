#pragma once

#include "base/result.hpp"
#include "engine/fields/description.hpp"
#include "engine/kinds/registry.hpp"
#include "engine/spec/spec_description.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

// Functions for code that visits all members of a spec (engine::WorldSpec, the description of a world that
// the engine uses) by means of tables. A table (engine::FieldTable) lists the fields of a struct: the name,
// type, unit, limits and default of each member. The tables of the structs of a spec are in
// engine/spec/spec_description.hpp. A stored world (worldio/json/spec_json.hpp) is a spec as JSON, in
// checkpoints and recordings.

namespace troupe::worldio {

/// One step of the path to a value of a spec, for error messages: a member of a struct, or an entry of a
/// list. Each step points to the step of the enclosing struct or list, which must outlive it. The text of the
/// path is made only when text() is called.
struct SpecPath {
  const SpecPath* parent = nullptr;  ///< step of the enclosing struct or list; null if that is the spec
  std::string_view name = {};        ///< name of the member; empty for a list's entry
  std::size_t index = 0;             ///< index of a list's entry, from 0

  std::string text() const;  ///< the whole path: `types[0].parts[2].size`
};

/// Whether a number, in SI units, is finite and within a field's limits.
inline bool is_within(const engine::Field& field, double x) {
  return std::isfinite(x) && x >= field.min && x <= field.max && !(field.above_min && x == field.min);
}
/// Returns the value of a field of type integer as a double.
inline double integer_number(const engine::Field& field, const engine::Value& value) {
  const std::int64_t x = value.integer();
  const bool is_unsigned = field.member != nullptr && field.member->is_unsigned;
  return is_unsigned ? static_cast<double>(static_cast<std::uint64_t>(x)) : static_cast<double>(x);
}

/// Whether the struct that `table` describes consists only of numbers, as a pose does. In a stored world,
/// such a struct is a list of numbers.
bool is_listed(const engine::FieldTable& table);
/// Returns how many numbers a struct has, including those of nested structs. `table` describes the struct;
/// is_listed(table) must be true.
std::size_t numbers_in(const engine::FieldTable& table);

/// Returns the address of the member that `field` describes in the struct at `object`.
///@{
inline const void* member_of(const engine::Field& field, const void* object) {
  return static_cast<const char*>(object) + field.offset;
}
inline void* member_of(const engine::Field& field, void* object) {
  return static_cast<char*>(object) + field.offset;
}
///@}
/// Returns the address of entry i of a list, or the address of a struct. `member` is the address of the list
/// or struct, and `type` describes it. For a struct, i must be 0. If the struct is optional, it must have a
/// value.
inline const void* block_of(const engine::MemberType& type, const void* member, std::size_t i) {
  return type.block(const_cast<void*>(member), i);
}

/// Returns the table of the parameters of a struct of a spec, such as those in DeviceSpec::params. `table` is
/// the table of the struct, and `object` points to the struct. The member `kind` of the struct names its kind
/// (sort of drive, device, controller, measure or fault), which determines the parameters. A WorldSpec has no
/// kind: its parameters are those in WorldSpec::window, and the result is window_fields(). If the kind is
/// unknown, or its plug-in cannot be loaded, returns an error with the reason.
Result<const engine::FieldTable*> parameters_of(const engine::FieldTable& table, const void* object,
                                                const engine::Registry& registry);

}  // namespace troupe::worldio
