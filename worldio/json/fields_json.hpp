#pragma once

#include "base/color.hpp"
#include "base/pose.hpp"
#include "engine/fields.hpp"
#include "worldio/json/json_reader.hpp"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace troupe::worldio {

/// Reads one field of an object, in SI units and within its limits. The key ends in the unit (`fov_rad`,
/// `fov_deg`). Not given if the object lacks the field, or, with an error, if its value is wrong.
engine::Value read_field(JsonObject& object, const engine::Field& field);

/// A field of an object and its place.
struct FoundField {
  engine::Value value;         ///< not given if the field is absent or wrong
  std::optional<Where> where;  ///< empty only if the field is absent
};
/// Like read_field(), with the place of the value.
FoundField find_field(JsonObject& object, const engine::Field& field);

/// Reads a value without a key (an entry of a list), in SI units and within the field's limits. Not given,
/// with an error, if it is wrong.
engine::Value read_value(const JsonCursor& at, const engine::Field& field);

/// Reads all fields of a table. An absent field takes its value from `presets`, else its default; an absent
/// required field is an error. The record is complete unless errors were reported.
engine::Record read_fields(JsonObject& object, const engine::FieldTable& table,
                           std::span<const std::pair<std::string_view, engine::Value>> presets = {});

/// Reads an X11 name, or [r, g, b] or [r, g, b, a] from 0 to 1. Empty, with an error, if it is wrong.
std::optional<Color> read_color(const JsonCursor& at);

// Written values read back to the same bits: an angle is written in degrees only if they convert back to the
// same radians.

/// Adds a value under the key of its field and unit; adds nothing if it is not given.
void write_field(const engine::Field& field, const engine::Value& value, JsonNode::Object& object);

/// Adds the fields that differ from their defaults.
void write_fields(const engine::Record& record, const engine::FieldTable& table, JsonNode::Object& object);

/// The inverse of read_color().
JsonNode color_node(const Color& color);

/// The double with the fewest digits that converts to this float.
double short_number(float x);

/// Whether two values are equal bit by bit: 0 and -0 differ.
bool same_bits(const engine::Value& a, const engine::Value& b);
bool same_bits(double a, double b);
bool same_bits(const Pose& a, const Pose& b);

/// Reads the object under a key, which has the fields of a table and no other keys. Empty if the key is
/// absent.
std::optional<engine::Record> read_block(JsonObject& object, std::string_view key,
                                         const engine::FieldTable& table);

/// The keys of a field, one per unit: `"fov_rad" or "fov_deg"`.
std::string quoted_keys(const engine::Field& field);

/// `from 0 to 360 deg`, `above 0 m`, ...; empty if the field has no limits.
std::string limits_text(const engine::Field& field, const engine::UnitSuffix& suffix);

}  // namespace troupe::worldio
