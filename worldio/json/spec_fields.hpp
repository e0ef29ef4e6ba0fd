#pragma once

#include "base/result.hpp"
#include "engine/fields/description.hpp"
#include "engine/kinds/kinds.hpp"
#include "engine/spec/spec_description.hpp"

#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>

// Functions for code that visits all members of a spec (engine::WorldSpec, the description of a world that
// the engine uses) by means of tables. A table (engine::FieldTable) lists the fields of a struct: the name,
// type, unit, limits and default of each member. The tables of the structs of a spec are in
// engine/spec/spec_description.hpp. A stored world (worldio/json/spec_json.hpp) is a spec as JSON, in
// checkpoints and recordings.

namespace troupe::worldio {

/// Path to a value of a spec (engine::WorldSpec): a chain of elements on the stack. Each element points to
/// the element of the enclosing struct or list, which must exist for at least as long. The text of a path is
/// made only for an error.
struct SpecPath {
  const SpecPath* parent = nullptr;  ///< path of the enclosing struct or list; null for the spec itself
  std::string_view name = {};        ///< name of the member; empty for a list's entry
  std::size_t index = 0;             ///< index of a list's entry, from 0

  std::string text() const;  ///< the whole path: `types[0].parts[2].size`
};

/// Returns the key of a field in a stored world: its name and its SI unit, as in "period_s".
std::string key_of(const engine::Field& field);

/// Whether a number, in SI units, is finite and within a field's limits.
inline bool is_within(const engine::Field& field, double x) {
  return std::isfinite(x) && x >= field.min && x <= field.max && !(field.above_min && x == field.min);
}

/// Whether the struct that `table` describes consists only of numbers, as a pose does. In a stored world,
/// such a struct is a list of numbers.
bool is_listed(const engine::FieldTable& table);
/// Returns how many numbers a struct has, including those of nested structs. The struct must consist only of
/// numbers, as is_listed() says.
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
/// Returns the address of one of the structs that a member holds: the member itself (i must be 0) or, if the
/// member is a list, its entry i. `type` describes the member and `member` is its address. The caller must
/// not change the result.
inline const void* block_of(const engine::MemberType& type, const void* member, std::size_t i) {
  return type.block(const_cast<void*>(member), i);
}

/// Returns the table of the parameters that a struct of a spec stores as an engine::Record, such as
/// DeviceSpec::params. `table` describes the struct and `object` points to it. If the struct has a member
/// `kind`, that member names a kind (sort of drive, device, controller, ...), and the parameters are those of
/// this kind. For a WorldSpec, the parameters are those of WorldSpec::window, the settings of the view of a
/// run. If the kind is unknown, or its plug-in cannot be loaded, returns an error with the reason.
Result<const engine::FieldTable*> parameters_of(const engine::FieldTable& table, const void* object,
                                                const engine::Registry& registry);

}  // namespace troupe::worldio
