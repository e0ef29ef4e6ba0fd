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

/// One field from an object, in SI units and within its limits; not given where the object does not have it
/// or where what it has is wrong, which is then reported. The unit stands in the key (`fov_rad`, `fov_deg`).
engine::Value read_field(JsonObject& object, const engine::Field& field);

/// The same, and where it stands: nothing where the object does not have it, right or wrong.
struct FoundField {
  engine::Value value;
  std::optional<Where> where;
};
FoundField find_field(JsonObject& object, const engine::Field& field);

/// A value that stands by itself (an entry of a list), in SI units and within the field's limits; not given,
/// and reported, where it is wrong.
engine::Value read_value(const JsonCursor& at, const engine::Field& field);

/// Every field of a table. What is absent takes its value from `presets` if it stands there, else its
/// default; a required field that is absent is an error. The record is complete unless errors were reported.
engine::Record read_fields(JsonObject& object, const engine::FieldTable& table,
                           std::span<const std::pair<std::string_view, engine::Value>> presets = {});

/// A colour's name, or [r, g, b] or [r, g, b, a] from 0 to 1. Empty, and reported, where it is wrong.
std::optional<Color> read_color(const JsonCursor& at);

// What is written reads back to the same bits: an angle stands in degrees only where these turn into the same
// radians again.

/// Adds a value under the key of its field and unit; nothing where it is not given.
void write_field(const engine::Field& field, const engine::Value& value, JsonNode::Object& object);

/// Adds the fields that read_fields() would not find otherwise: those that are not at their default.
void write_fields(const engine::Record& record, const engine::FieldTable& table, JsonNode::Object& object);

/// As read_color() reads it.
JsonNode color_node(const Color& color);

/// The number of few digits that is this float once it is read as one.
double short_number(float x);

/// Whether two values are the same to the last bit: 0 and -0 are not.
bool same_bits(const engine::Value& a, const engine::Value& b);
bool same_bits(double a, double b);
bool same_bits(const Pose& a, const Pose& b);

/// The object under a key, every field of a table and nothing else; empty where the key is not there.
std::optional<engine::Record> read_block(JsonObject& object, std::string_view key,
                                         const engine::FieldTable& table);

/// The keys under which a field may be written: `"fov_rad" or "fov_deg"`.
std::string quoted_keys(const engine::Field& field);

/// `from 0 to 360 deg`, `above 0 m`, ...; empty where a field takes any number.
std::string limits_text(const engine::Field& field, const engine::UnitSuffix& suffix);

}  // namespace troupe::worldio
