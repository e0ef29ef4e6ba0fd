#pragma once

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

/// The values of a parameter block, such as the parameters of a sensor: one value for each field of the
/// block's FieldTable, in the order of the fields.
using Record = std::vector<Value>;

/// The value of a parameter, in SI units, or no value.
struct Value {
  std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<double>,
               std::vector<Record>, std::vector<std::string>>
      v;  ///< the value; std::monostate: no value was given

  // None of these functions is inline: nearly every source file makes and copies records, and each would
  // instantiate the variant's members again.
  /// Makes an object without a value: given() is false.
  Value();
  Value(const Value&);                 ///< copies the value
  Value(Value&&) noexcept;             ///< moves the value
  Value& operator=(const Value&);      ///< copies the value
  Value& operator=(Value&&) noexcept;  ///< moves the value
  ~Value();
  /// Makes a value of the type of the argument: 1 becomes an integer and 1.0 a number. A `const char*` must
  /// not be null.
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
  /// The value, which must have the type that the function names: an integer is not a number. Throws
  /// std::bad_variant_access if it has another type or none. In a record that a reader has checked against a
  /// field table, each value has the type of its field, or none.
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

/// The type of a parameter. Unless stated otherwise, a Value stores the parameter in the C++ type that its
/// function of the same name returns: Value::boolean() for `boolean`, for example.
enum class FieldType {
  boolean,  ///< true or false
  integer,  ///< an integer of 64 bits
  number,   ///< a double, of the field's unit
  text,     ///< a string; if Field::choices is not empty, one of these
  texts,    ///< a list of strings, of any length
  numbers,  ///< a list of numbers of one unit; its length is Field::columns, or any if that is 0
  /// A colour; files may also give its name. Stored as four numbers, 0 to 1: red, green, blue, opacity.
  color,
  /// A list of opaque colours of any length. Stored as three numbers, 0 to 1, for each colour: red, green,
  /// blue, red, ...
  colors,
  record,   ///< one parameter block, described by Field::record; stored as a list of one record
  records,  ///< a list of parameter blocks, described by Field::record
};

struct FieldTable;
struct MemberType;

/// The description of a parameter of a kind (a sort of sensor, drive or controller), or of a member of a
/// described struct (engine/fields/description.hpp). Parsing, validation, error messages, `troupe describe`
/// and the reference page are derived from it. The strings must live as long as the field.
struct Field {
  std::string_view name;               ///< lower case with underscores; keys in files append the unit
  FieldType type = FieldType::number;  ///< type of the value
  Unit unit = Unit::none;              ///< unit of the number, or of each number of a list
  /// Default value, in SI units. If this member has no value (Value::given() is false), the field has no
  /// default and is required, with two exceptions. A field with `optional` may be missing. A missing field of
  /// type record has the defaults of the fields of the table `record`.
  Value fallback;
  /// Lower limit of the number, or of each number of a list, in SI units. The limit itself is allowed, unless
  /// above_min is set.
  double min = -std::numeric_limits<double>::infinity();
  /// Upper limit of the number, or of each number of a list, in SI units. The limit itself is allowed.
  double max = std::numeric_limits<double>::infinity();
  std::string_view text;                  ///< meaning in one sentence, for documentation and errors
  std::size_t columns = 0;                ///< for type numbers: length of the list; 0: any length
  std::vector<std::string_view> choices;  ///< for type text: the allowed values; empty: any text
  /// For types record and records: the fields of a block. The table must outlive this object. Null for all
  /// other types, and for a block whose table only the code that reads the field knows.
  const FieldTable* record = nullptr;
  /// True: the number must be greater than `min`, not equal to it (for example a size or a period).
  bool above_min = false;
  /// For type integer: the value is a number of readings of a sensor. The sum of all such fields of a device
  /// must not exceed 1,000,000. The engine checks this limit before it allocates the memory of the sensor.
  bool counts_readings = false;
  /// True: the field may be missing in a file, and then has no value (Value::given() is false). It is not
  /// required and has no default.
  bool optional = false;
  /// True: the parameter cannot change while the world runs, neither by an intervention (a change that the
  /// world file lists) nor by World::set(). For parameters of controllers, this member has no effect.
  bool fixed = false;
  /// True: the field records where the other fields come from (a file and a line). It is stored, but
  /// comparisons of records ignore it.
  bool provenance = false;
  /// For a field of the state of a world: the field adds nothing to the hash of the state while it is zero
  /// (StateField::sparse). For other fields: a stored record may lack the field, which then has its default.
  bool sparse = false;
  /// For a field of the state of a world: the appearance of a body depends on it (StateField::appearance).
  bool appearance = false;
  /// For a member of a described struct (engine/fields/description.hpp): functions that read and write the
  /// member, and its offset in the struct. `member` points to static storage. It is null for fields that do
  /// not describe a member of a struct, and for members that generic code cannot read or write
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

  /// Index of the field with this name; -1 if there is none.
  int find(std::string_view name) const;
  /// Returns a record of the default values. For required and optional fields, which have no default,
  /// Value::given() is false. A field of type record that is not optional and has no default gets the
  /// defaults() of its table Field::record.
  Record defaults() const;
};

/// A suffix by which the key of a number in a file names its unit, with the factor to the SI unit. Example:
/// {"_deg", "deg", pi/180}.
struct UnitSuffix {
  std::string_view suffix;  ///< end of the key: "_deg"; empty for Unit::none
  std::string_view symbol;  ///< symbol of the unit in messages: "rad", "deg", "m/s"
  double to_si;  ///< factor from this unit to SI: a value in the file times `to_si` is the value in SI
};
/// The key suffixes for a unit; the suffix for the SI unit is the first. Never empty: for Unit::none, one
/// suffix with empty strings. The list has static storage.
std::span<const UnitSuffix> unit_suffixes(Unit unit);

/// The value of the field with this name in `record`, a record of `table`. The table must have the field;
/// this function does not check that.
inline const Value& get(const FieldTable& table, const Record& record, std::string_view name) {
  return record[static_cast<std::size_t>(table.find(name))];
}

/// The table of the fields of a pose: x, y, z (m) and heading (rad), each 0 by default. Each call returns the
/// same object. Code can therefore recognise a field that is a pose by this address in Field::record.
const FieldTable& pose_fields();

}  // namespace troupe::engine
