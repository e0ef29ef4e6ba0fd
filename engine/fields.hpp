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

/// The values of a parameter block, in the order of its field table.
using Record = std::vector<Value>;

/// The value of a parameter, in SI units.
struct Value {
  std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<double>,
               std::vector<Record>, std::vector<std::string>>
      v;  ///< std::monostate: not given

  // None of these is inline: records are made and copied in nearly every source, and each would instantiate
  // the variant's members again.
  /// A value that is not given.
  Value();
  Value(const Value&);                 ///< a copy
  Value(Value&&) noexcept;             ///< moves
  Value& operator=(const Value&);      ///< a copy
  Value& operator=(Value&&) noexcept;  ///< moves
  ~Value();
  /// A value of a field. The type is kept: 1 is an integer and 1.0 a number.
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
  /// The value as its type. Throws std::bad_variant_access if it has another type; the reader of a field
  /// table has checked it.
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

/// The dimension of a number. A JSON key carries its unit: the field `fov` (rad) is written `fov_rad` or
/// `fov_deg`, `range` (m) is `range_m`, `range_cm` or `range_mm`; fields without a dimension have no suffix.
enum class Unit {
  none,                        ///< dimensionless, or no number
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

/// The type of a parameter.
enum class FieldType {
  boolean,  ///< true or false
  integer,  ///< 64 bits
  number,   ///< a double, of the field's unit
  text,     ///< one of `choices`, if there are any
  texts,    ///< a list of texts of any length
  numbers,  ///< `columns` numbers of one unit; columns 0: any count
  color,    ///< a colour, also by name in files (stored as numbers: red, green, blue, opacity)
  colors,   ///< a list of colours of any length (stored as numbers: red, green, blue, opacity, red, ...)
  record,   ///< one parameter block, described by `record` (stored as a list of one)
  records,  ///< a list of parameter blocks, described by `record`
};

struct FieldTable;
struct MemberType;

/// A parameter of a kind. Parsing, validation, error messages, `troupe describe` and the reference page are
/// derived from it.
struct Field {
  std::string_view name;               ///< lower case with underscores; files append the unit
  FieldType type = FieldType::number;  ///< type of the value
  Unit unit = Unit::none;              ///< of number and numbers
  /// Default value. Not given: the field is required, unless it is optional or a record.
  Value fallback;
  double min =
      -std::numeric_limits<double>::infinity();          ///< smallest number, in SI units; in a list, of each
  double max = std::numeric_limits<double>::infinity();  ///< largest number, included
  std::string_view text;                  ///< one sentence for `troupe describe`, errors and the schema
  std::size_t columns = 0;                ///< length of `numbers`; 0: any
  std::vector<std::string_view> choices;  ///< allowed values of `text`; empty: any text
  const FieldTable* record = nullptr;     ///< for `record` and `records`; must outlive the field
  /// The lower limit itself is not allowed (sizes, periods).
  bool above_min = false;
  /// For `integer`: a number of readings of a sensor. Their sum limits the memory of a device before it is
  /// allocated.
  bool counts_readings = false;
  /// The field may be missing, and then has no value: it is not required and has no default.
  bool optional = false;
  /// Interventions cannot change it while the world runs.
  bool fixed = false;
  /// It records the origin of the other fields (a file and a line): it is stored, but not compared.
  bool provenance = false;
  bool sparse = false;      ///< for state: StateField::sparse
  bool appearance = false;  ///< for state: StateField::appearance
  /// For a described struct (engine/description.hpp): access to the member, and its offset in the struct.
  ///@{
  const MemberType* member = nullptr;
  std::size_t offset = 0;  ///< bytes
  ///@}

  /// Whether a file must give the field.
  bool required() const { return !fallback.given() && !optional && type != FieldType::record; }
};

/// The parameters of one kind. Field names are unique.
struct FieldTable {
  std::vector<Field> fields;  ///< in the order of the records' values

  /// Index of a field, or -1.
  int find(std::string_view name) const;
  /// A record of the default values; required fields are not given.
  Record defaults() const;
};

/// A key suffix for a unit, with the factor to SI: {"_deg", "deg", pi/180}.
struct UnitSuffix {
  std::string_view suffix;  ///< end of the key: "_deg"; empty for Unit::none
  std::string_view symbol;  ///< for messages: "rad", "deg", "m/s"
  double to_si;             ///< factor from this unit to SI
};
/// The suffixes of a unit, the SI one first. Never empty; static storage.
std::span<const UnitSuffix> unit_suffixes(Unit unit);

/// The value of a field by name. The table must have the field.
inline const Value& get(const FieldTable& table, const Record& record, std::string_view name) {
  return record[static_cast<std::size_t>(table.find(name))];
}

/// The table of poses: x, y, z (m) and heading (rad), each 0 by default.
const FieldTable& pose_fields();

}  // namespace troupe::engine
