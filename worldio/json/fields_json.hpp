#pragma once

#include "base/color.hpp"
#include "base/pose.hpp"
#include "engine/fields/fields.hpp"
#include "worldio/json/json_reader.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

/// Reads and writes parameters as keys of JSON objects.
///
/// field   the description of one parameter: its name, type, unit, limits and default (engine::Field)
/// table   a list of the fields of one object (engine::FieldTable)
/// value   the value of a parameter, in SI units, or an empty value, for which given() is false
///         (engine::Value)
/// record  one value for each field of a table, in the order of the table (engine::Record)
/// cursor  a JSON value that is being read, with its path for errors (JsonCursor)
namespace troupe::worldio {

/// Returns the value of a number; integers beyond 2^53 are rounded. Empty for any other JSON value.
std::optional<double> real_number_of(const JsonNode& node);

/// Returns the value of a whole number, which may be written as 5, 5.0 or 5e0. Empty for any other JSON
/// value, for a whole number outside -2^63 to 2^63 - 1, and for a number such as 1e17, which has a point or
/// an exponent and is beyond 2^53.
std::optional<std::int64_t> whole_number_of(const JsonNode& node);

/// Reads one field of an object and returns its value. The key of a field with a unit ends in the unit, such
/// as `fov_rad` or `fov_deg`. Returns an empty value if the object lacks the field. If the value is wrong
/// (its type, or a number outside the limits of the field), or if the key lacks its unit, reports an error
/// and returns an empty value. If the object has the field in two units, reports an error and returns one of
/// the two values.
engine::Value read_field(JsonObject& object, const engine::Field& field);

/// The value of a field in an object, and the place of this value in the file.
struct FoundField {
  engine::Value value;         ///< empty if the field is absent or wrong
  std::optional<Where> where;  ///< not set if the object lacks the field
};
/// Like read_field(), but also returns the place of the value. If the field has no effect in this object,
/// `unused` says why (engine::unused_reason()): numbers outside its limits are then warnings.
FoundField find_field(JsonObject& object, const engine::Field& field, const std::string& unused = {});

/// Reads a JSON value that has no key, such as an entry of a list, as a value of `field`. Numbers must be in
/// the SI unit of the field. If the JSON value has the wrong type or is outside the limits of the field,
/// reports an error and returns an empty value.
engine::Value read_value(const JsonCursor& at, const engine::Field& field);

/// Reads all fields of a table from an object. `presets` are pairs of a field name and a value, which
/// replaces the default of this field.
/// - A field that the object lacks gets its default value. If it has no default, its value is empty; this is
///   an error unless the field is optional.
/// - A field with a wrong value is an error, and gets its default value.
/// - Unknown keys are not reported here; JsonObject::finish() reports them.
engine::Record read_fields(JsonObject& object, const engine::FieldTable& table,
                           std::span<const std::pair<std::string_view, engine::Value>> presets = {});
/// Like read_fields(), for the parameters in a world file: a field that the object lacks has the value
/// Field::in_json, if the field has one, and a limit may be minus the limit of the other side
/// (Field::mirror).
engine::Record read_parameters(JsonObject& object, const engine::FieldTable& table,
                               std::span<const std::pair<std::string_view, engine::Value>> presets = {});

/// Reads a colour: an X11 name, or [r, g, b] or [r, g, b, a] with numbers from 0 to 1. If the value is none
/// of these, reports an error and returns nothing.
std::optional<Color> read_color(const JsonCursor& at);

// The functions below write values so that each value reads back as the same bits. An angle is therefore
// written in degrees only if the degrees convert back to exactly the same radians.

/// Adds a value, in SI units, to an object. The value must have the type of the field. The key is the name of
/// the field followed by the unit, such as `fov_deg`. Adds nothing if given() is false for the value.
void write_field(const engine::Field& field, const engine::Value& value, JsonNode::Object& object);

/// Adds to an object those fields of a record whose values differ in any bit from their defaults.
void write_fields(const engine::Record& record, const engine::FieldTable& table, JsonNode::Object& object);
/// Writes the fields so that read_parameters() reads them. Adds both limits of a pair (Field::mirror) if
/// either differs from its default.
void write_parameters(const engine::Record& record, const engine::FieldTable& table,
                      JsonNode::Object& object);

/// Returns the node that read_color() reads as this colour: an X11 name if the colour has one, else a list of
/// numbers.
JsonNode color_node(const Color& color);

/// Returns the double with the fewest decimal digits that converts to exactly this float.
double short_number(float x);

/// Whether two values have the same type and are equal bit by bit: 0 and -0 differ, and a NaN equals a NaN
/// with the same bits.
bool same_bits(const engine::Value& a, const engine::Value& b);
bool same_bits(double a, double b);
bool same_bits(const Pose& a, const Pose& b);

/// Reads the object that is the value of `key`, as read_fields() does. In contrast to read_fields(), every
/// key that is not a field of `table` is an error. Returns nothing if `key` is absent. If the value of `key`
/// is not an object, reports an error and returns a record of the defaults.
std::optional<engine::Record> read_block(JsonObject& object, std::string_view key,
                                         const engine::FieldTable& table);

/// Returns the key of a field in its SI unit, such as `fov_rad`.
std::string key_of(const engine::Field& field);
/// Whether a key is the name of a field followed by one of its units, such as `fov_rad` or `fov_deg`, or
/// without the unit.
bool is_spelled(const engine::Field& field, std::string_view key);
/// Returns the possible keys of a field, one for each unit, for messages: `"fov_rad" or "fov_deg"`.
std::string quoted_keys(const engine::Field& field);

/// Returns the limits of a field, converted to the unit `suffix`, for messages, such as `from 0 to 360 deg`
/// or `above 0 m`. Infinite limits are left out; the result is empty if both limits are infinite.
std::string limits_text(const engine::Field& field, const engine::UnitSuffix& suffix);

}  // namespace troupe::worldio
