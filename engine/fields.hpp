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

/// The values of one block of parameters, in the order of its field table.
using Record = std::vector<Value>;

/// One parameter as a world file gives it, in SI units.
struct Value {
  std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<double>,
               std::vector<Record>, std::vector<std::string>>
      v;  ///< nothing at all: not given

  // None is inline: records are made and copied in nearly every source, and each would compile the variant's
  // own again.
  /// Not given.
  Value();
  Value(const Value&);                 ///< a copy
  Value(Value&&) noexcept;             ///< takes what the other holds
  Value& operator=(const Value&);      ///< a copy
  Value& operator=(Value&&) noexcept;  ///< takes what the other holds
  ~Value();
  /// Of what fields hold, each kept as what it is: 1 is an integer and 1.0 a number.
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

  /// False: no value stands there.
  bool given() const { return !std::holds_alternative<std::monostate>(v); }
  /// What it holds. Throws std::bad_variant_access where it is something else: a field table's reader has
  /// seen to it.
  ///@{
  bool boolean() const { return std::get<bool>(v); }
  std::int64_t integer() const { return std::get<std::int64_t>(v); }
  double number() const { return std::get<double>(v); }
  const std::string& text() const { return std::get<std::string>(v); }
  const std::vector<double>& numbers() const { return std::get<std::vector<double>>(v); }
  const std::vector<Record>& records() const { return std::get<std::vector<Record>>(v); }
  const std::vector<std::string>& texts() const { return std::get<std::vector<std::string>>(v); }
  ///@}
  friend bool operator==(const Value&, const Value&);  ///< of one kind, and equal
};

/// The dimension of a number. A JSON key carries its unit: the field `fov` (rad) is written `fov_rad` or
/// `fov_deg`, `range` (m) is `range_m`, `range_cm` or `range_mm`; fields without a dimension stand bare.
enum class Unit {
  none,                        ///< a bare number, or no number
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

/// What a parameter is.
enum class FieldType {
  boolean,  ///< true or false
  integer,  ///< whole, 64 bits
  number,   ///< a double, of the field's unit
  text,     ///< one of `choices` where there are any
  texts,    ///< any count of texts
  numbers,  ///< `columns` numbers of one unit; columns 0: any count
  color,    ///< one that files may name (stored as numbers: red, green, blue, opacity)
  colors,   ///< any count of colours, which files may name (stored as numbers: red, green, blue, ...)
  record,   ///< one block described by `record` (stored as a list of one)
  records,  ///< a list of blocks described by `record`
};

struct FieldTable;
struct MemberType;

/// One parameter of a kind: from this parsing, validation, error texts, `troupe describe` and the reference
/// page are made.
struct Field {
  std::string_view name;               ///< lower case with underscores; in files its unit stands behind it
  FieldType type = FieldType::number;  ///< what it is
  Unit unit = Unit::none;              ///< of number and numbers
  /// Not given: the field is required.
  Value fallback;
  double min = -std::numeric_limits<double>::infinity();  ///< of numbers, in SI; of lists, each
  double max = std::numeric_limits<double>::infinity();   ///< as `min`; included
  std::string_view text;                  ///< one sentence for `troupe describe`, errors and the schema
  std::size_t columns = 0;                ///< of `numbers`
  std::vector<std::string_view> choices;  ///< of `text`; empty: any text
  const FieldTable* record = nullptr;     ///< of `record` and `records`; must outlive the field
  /// The lower limit itself is refused (sizes, periods).
  bool above_min = false;
  /// Of `integer`: how many readings a sensor has for it. What memory a device takes is known by the sum of
  /// these, before any is taken.
  bool counts_readings = false;
  /// It may be missing, and then has no value: it is neither required nor has it a fallback.
  bool optional = false;
  /// It stays as it is for as long as the world runs: interventions cannot change it.
  bool fixed = false;
  /// It says where the others come from (a file and a line): stored, and not compared.
  bool provenance = false;
  bool sparse = false;  ///< of state: StateField::sparse
  bool look = false;    ///< of state: StateField::look
  /// Of a described struct (engine/description.hpp): how the member is read and written, and where it lies.
  ///@{
  const MemberType* member = nullptr;
  std::size_t offset = 0;  ///< bytes
  ///@}

  /// Nothing stands in for it where it is not given, and something must.
  bool required() const { return !fallback.given() && !optional && type != FieldType::record; }
};

/// The parameters of one kind. Field names are unique.
struct FieldTable {
  std::vector<Field> fields;  ///< in the order of the records' values

  /// Position of a field, or -1.
  int find(std::string_view name) const;
  /// Every field at its default; required fields are left not given.
  Record defaults() const;
};

/// Key suffixes of a unit with the factor to SI, the SI one first: {"_rad", 1}, {"_deg", pi/180}.
struct UnitSuffix {
  std::string_view suffix;  ///< as keys end: "_deg"; of no unit empty
  std::string_view symbol;  ///< for people: "rad", "deg", "m/s"
  double to_si;             ///< factor from this unit to SI
};
std::span<const UnitSuffix> unit_suffixes(Unit unit);  ///< never empty; static storage

/// The value of a field, by its name; the table must have it.
inline const Value& get(const FieldTable& table, const Record& record, std::string_view name) {
  return record[static_cast<std::size_t>(table.find(name))];
}

/// The fields x, y, z (m) and heading (rad), each 0 by default: how poses are written.
const FieldTable& pose_fields();

}  // namespace troupe::engine
