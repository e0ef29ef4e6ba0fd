#pragma once

#include "engine/kinds/registry.hpp"

#include <string>

namespace troupe::worldio {

struct DocumentKey;
struct DocumentTable;

/// Returns the key of a field, and in parentheses the endings of the other units that the key can have:
/// "pitch_m (_cm, _mm)".
std::string key_text(const engine::Field& field);
/// Returns Field::text, followed by what Field::mirror says about a world file that lacks the field.
std::string meaning_text(const engine::Field& field);

/// The description of a key of a JSON object, as plain text.
struct KeyRow {
  std::string names;    ///< the key, as key_text() returns it
  std::string value;    ///< allowed values: "number, above 0 m"
  std::string usual;    ///< default value, "none" or "required"
  std::string meaning;  ///< may be empty
};
/// Returns the description of the key `key`, which is one of the keys of `table`.
KeyRow key_row(const DocumentTable& table, const DocumentKey& key, const engine::Registry& registry);
/// Returns the description of a parameter of a kind, or of a field of another object.
KeyRow key_row(const engine::Field& field);

}  // namespace troupe::worldio
