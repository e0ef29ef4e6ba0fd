#pragma once

#include "base/result.hpp"

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace troupe::engine {

struct Value;

/// The values of a parameter block, which is a group of named parameters, such as those of a sensor. The
/// record has one value for each field of the block's FieldTable, in the order of the fields.
using Record = std::vector<Value>;

/// The value of a parameter, in SI units, or no value.
struct Value {
  /// The value; std::monostate: no value was given.
  std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<double>,
               std::vector<Record>, std::vector<std::string>>
      v;

  // None of these functions is inline: nearly every source file makes and copies records, and each would
  // instantiate the variant's members again.
  /// Makes an object without a value: given() is false.
  Value();
  Value(const Value&);                 ///< copies the value
  Value(Value&&) noexcept;             ///< moves the value
  Value& operator=(const Value&);      ///< copies the value
  Value& operator=(Value&&) noexcept;  ///< moves the value
  ~Value();
  /// Makes a value that holds the argument. An int is stored as a std::int64_t. A `const char*`, which must
  /// not be null, is stored as a std::string.
  ///@{
  Value(bool x);
  Value(int x);
  Value(std::int64_t x);
  Value(double x);
  Value(const char* x);
  Value(std::string x);
  Value(std::vector<double> x);
  Value(std::vector<Record> x);
  Value(std::vector<std::string> x);
  ///@}

  /// Whether there is a value.
  bool given() const { return !std::holds_alternative<std::monostate>(v); }
  /// Returns the value, without conversion: number(), for example, does not accept an integer. Throws
  /// std::bad_variant_access if the value has another type, or if there is no value. In a record that a
  /// reader of files has checked against a FieldTable, every value has the type of its field, or is not
  /// given().
  ///@{
  bool boolean() const { return std::get<bool>(v); }
  std::int64_t integer() const { return std::get<std::int64_t>(v); }
  double number() const { return std::get<double>(v); }
  const std::string& text() const { return std::get<std::string>(v); }
  const std::vector<double>& numbers() const { return std::get<std::vector<double>>(v); }
  const std::vector<Record>& records() const { return std::get<std::vector<Record>>(v); }
  const std::vector<std::string>& texts() const { return std::get<std::vector<std::string>>(v); }
  ///@}
  friend bool operator==(const Value&, const Value&);  ///< same type and equal value
};

/// The SI unit of a number. In JSON files the unit is part of the key, as a suffix: the field `fov` (rad) is
/// written `fov_rad` or `fov_deg`, and `range` (m) is written `range_m`, `range_cm` or `range_mm`
/// (unit_suffixes()). Fields without a unit have no suffix.
enum class Unit {
  none,                        ///< dimensionless, or not a number
  meters,                      ///< m
  radians,                     ///< rad
  seconds,                     ///< s
  meters_per_second,           ///< m/s
  radians_per_second,          ///< rad/s
  meters_per_second_squared,   ///< m/s^2
  radians_per_second_squared,  ///< rad/s^2
  per_second,                  ///< 1/s
  kilograms,                   ///< kg
  joules,                      ///< J
  watts,                       ///< W
};

/// The type of a parameter. A Value stores a parameter of the type `boolean` in the C++ type that
/// Value::boolean() returns. The same holds for the other types that have the name of a function of Value.
/// The remaining types are stored as their comments say.
enum class FieldType {
  boolean,  ///< true or false
  integer,  ///< an integer of 64 bits
  number,   ///< a double, of the field's unit
  text,     ///< a string; if Field::choices is not empty, one of these
  texts,    ///< a list of strings, of any length
  numbers,  ///< a list of numbers of one unit; its length is Field::columns, or any if that is 0
  /// A colour; files may also give its name. Stored as four numbers (Value::numbers()) from 0 to 1: red,
  /// green, blue, opacity.
  color,
  /// A list of opaque colours, of any length. Stored as three numbers from 0 to 1 for each colour: red,
  /// green, blue of the first colour, then of the second, and so on.
  colors,
  record,   ///< one parameter block, described by Field::record; stored as a list of one record
  records,  ///< a list of parameter blocks, described by Field::record
};

struct FieldTable;
struct MemberType;

/// A condition on another field of the same record: its value is, or is not, `value`. A Field with such a
/// condition has an effect only if the condition holds.
struct FieldCondition {
  std::string_view field = {};  ///< name of the other field; empty: no condition
  std::string_view value = {};  ///< a text, a whole number, "true" or "false"
  bool is = true;               ///< false: any other value than `value`
};

/// Describes a parameter of a kind (a sort of sensor, drive or controller), or a member of a described struct
/// (engine/fields/description.hpp). Parsing, validation, error messages, `troupe describe` and the reference
/// page use these descriptions. The characters of all strings must live as long as the field.
struct Field {
  std::string_view name = {};          ///< lower case with underscores; keys in files append the unit
  FieldType type = FieldType::number;  ///< type of the value
  Unit unit = Unit::none;              ///< unit of the number, or of each number of a list
  /// Default value, in SI units. It may be empty (Value::given() is false). What happens if a file lacks the
  /// field then depends on the field:
  /// - If `optional` is true, the parameter has no value.
  /// - If the type is record, the parameter has the defaults of the table `record`.
  /// - Otherwise a missing field is an error (required()).
  Value fallback = {};
  /// Value of the field if a world file in JSON lacks it, in SI units. Empty: `fallback`.
  Value in_json = {};
  /// Value of the field if a world file in JSON lacks it.
  const Value& usual_in_json() const { return in_json.given() ? in_json : fallback; }
  /// Whether a world file in JSON that lacks the field means that there is no limit.
  bool is_without_limit() const { return in_json.given() && type == FieldType::number; }
  /// Lower limit of the number, or of each number of a list, in SI units. The limit itself is allowed, unless
  /// above_min is set.
  double min = -std::numeric_limits<double>::infinity();
  /// Upper limit of the number, or of each number of a list, in SI units. The limit itself is allowed.
  double max = std::numeric_limits<double>::infinity();
  std::string_view text = {};                  ///< meaning in one sentence, for documentation and errors
  std::size_t columns = 0;                     ///< for type numbers: length of the list; 0: any length
  std::vector<std::string_view> choices = {};  ///< for type text: the allowed values; empty: any text
  /// For types record and records: the table of the fields of a block. The table must outlive this object.
  /// Null for all other types, and for members of the C++ type Record, whose table only the code that reads
  /// them knows.
  const FieldTable* record = nullptr;
  /// True: the number must be greater than `min`, not equal to it (for example a size or a period).
  bool above_min = false;
  /// True (only for type integer): the value is a number of readings of a sensor. The sum of all such fields
  /// of a device must not exceed 1,000,000. The engine checks this before it allocates the sensor's memory.
  bool counts_readings = false;
  /// True: a file may omit the field. The parameter then has no value (Value::given() is false). The field
  /// has no default.
  bool optional = false;
  /// For one of two limits, a lower and an upper one: the name of the field of the other limit; empty: none.
  /// If a world file gives only the other limit, and this is on the other side of 0 than `fallback`, this
  /// limit is minus the other one.
  std::string_view mirror = {};
  /// True: the parameter cannot change while the world runs, neither by an intervention (a change that the
  /// world file lists) nor by World::set(). For parameters of controllers, this member has no effect.
  bool fixed = false;
  /// True: the field tells where the data come from, for example the file and the line. It is stored, but
  /// ignored when two records are compared.
  bool provenance = false;
  /// The condition on which the parameter has an effect. While it does not hold, the readers of files accept
  /// a number outside the limits with a warning (is_used()).
  FieldCondition used_if = {};
  /// For a field of the state of a world: the field adds nothing to the hash of the state while it is zero
  /// (StateField::sparse). For other fields: a stored record may lack the field, which then has its default.
  bool sparse = false;
  /// For a field of the state of a world: the appearance of a body depends on it (StateField::appearance).
  bool appearance = false;
  /// For a member of a described struct (engine/fields/description.hpp): functions that read and write the
  /// member, and its offset in the struct. `member` points to static storage. It is null if the field does
  /// not describe a member of a struct, or if generic code cannot read or write the member
  /// (Description::apart()).
  ///@{
  const MemberType* member = nullptr;
  std::size_t offset = 0;  ///< offset in the struct, bytes
  ///@}

  /// Whether a file must give the field: it has no default, is not optional, and is not of type record.
  bool required() const { return !fallback.given() && !optional && type != FieldType::record; }
};

/// The parameters of one kind (a sort of sensor, drive or controller), or the members of one described
/// struct. Field names must be unique, which the table does not check.
struct FieldTable {
  std::vector<Field> fields;  ///< the fields; a Record has its values in the same order

  /// Returns the index of the field with this name; -1 if there is none.
  int find(std::string_view name) const;
  /// Returns the field with this name. Throws std::out_of_range if there is none.
  ///@{
  const Field& at(std::string_view name) const { return fields.at(static_cast<std::size_t>(find(name))); }
  Field& at(std::string_view name) { return fields.at(static_cast<std::size_t>(find(name))); }
  ///@}
  /// Returns a record with the default Field::fallback of each field. Required and optional fields have no
  /// default: Value::given() is false. If a field of type record has no fallback and is not optional, its
  /// value is the record of the defaults() of its table Field::record.
  Record defaults() const;
};

/// A suffix by which the key of a number in a file names its unit, with the factor to the SI unit. Example:
/// {"_deg", "deg", pi/180}.
struct UnitSuffix {
  std::string_view suffix;  ///< end of the key: "_deg"; empty for Unit::none
  std::string_view symbol;  ///< symbol of the unit in messages: "rad", "deg", "m/s"
  double to_si;  ///< factor from this unit to SI: a value in the file times `to_si` is the value in SI
};
/// Returns the key suffixes for a unit. The first one is the suffix for the SI unit. For Unit::none, the list
/// has one suffix with empty strings. The list has static storage.
std::span<const UnitSuffix> unit_suffixes(Unit unit);
/// Returns all units except Unit::none, in the order of their declarations.
std::vector<Unit> all_units();

/// Returns the value of the field with this name. `record` must be a record of `table`, and the table must
/// have the field; neither is checked.
///@{
inline const Value& get(const FieldTable& table, const Record& record, std::string_view name) {
  return record[static_cast<std::size_t>(table.find(name))];
}
inline Value& get(const FieldTable& table, Record& record, std::string_view name) {
  return record[static_cast<std::size_t>(table.find(name))];
}
///@}

/// Whether a parameter with these values of the other parameters has an effect (Field::used_if). Also true if
/// `record` has no value of the field on which this depends.
bool is_used(const FieldTable& table, const Record& record, const Field& field);
/// Returns why a parameter for which is_used() is false has no effect: `"localization" is "gps"`.
std::string unused_reason(const FieldTable& table, const Record& record, const Field& field);
/// Checks the limits of all parameters with a condition, and of those in blocks, that have an effect. A
/// reader has accepted their values while they had none.
Result<> check_used(const FieldTable& table, const Record& record);

/// Returns the table of the fields of a pose: x, y, z (m) and heading (rad), each 0 by default. Every call
/// returns the same object. A field is therefore a pose if its Field::record has the address of this object.
const FieldTable& pose_fields();

}  // namespace troupe::engine
