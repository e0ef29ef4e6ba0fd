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
               std::vector<Record>>
      v;

  Value() = default;
  Value(bool x) : v(x) {}
  Value(int x) : v(std::int64_t{x}) {}
  Value(std::int64_t x) : v(x) {}
  Value(double x) : v(x) {}
  Value(const char* x) : v(std::string(x)) {}
  Value(std::string x) : v(std::move(x)) {}
  Value(std::vector<double> x) : v(std::move(x)) {}
  Value(std::vector<Record> x) : v(std::move(x)) {}

  bool given() const { return !std::holds_alternative<std::monostate>(v); }
  bool boolean() const { return std::get<bool>(v); }
  std::int64_t integer() const { return std::get<std::int64_t>(v); }
  double number() const { return std::get<double>(v); }
  const std::string& text() const { return std::get<std::string>(v); }
  const std::vector<double>& numbers() const { return std::get<std::vector<double>>(v); }
  const std::vector<Record>& records() const { return std::get<std::vector<Record>>(v); }
  friend bool operator==(const Value&, const Value&) = default;
};

/// The dimension of a number. A JSON key carries its unit: the field `fov` (rad) is written `fov_rad` or
/// `fov_deg`, `range` (m) is `range_m`, `range_cm` or `range_mm`; fields without a dimension stand bare.
enum class Unit {
  none,
  meters,
  radians,
  seconds,
  meters_per_second,
  radians_per_second,
  meters_per_second_squared,
  radians_per_second_squared,
  per_second,
  kilograms,
  joules,
  watts
};

enum class FieldType {
  boolean,
  integer,
  number,
  text,     ///< one of `choices` where there are any
  numbers,  ///< `columns` numbers of one unit; columns 0: any count
  colors,   ///< any count of colours, which files may name (stored as numbers: red, green, blue, ...)
  record,   ///< one block described by `record` (stored as a list of one)
  records,  ///< a list of blocks described by `record`
};

struct FieldTable;

/// One parameter of a kind: from this parsing, validation, error texts, `troupe describe` and the reference
/// page are made.
struct Field {
  std::string_view name;
  FieldType type = FieldType::number;
  Unit unit = Unit::none;
  /// Not given: the field is required.
  Value fallback;
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  std::string_view text;
  std::size_t columns = 0;
  std::vector<std::string_view> choices;
  const FieldTable* record = nullptr;
  /// The lower limit itself is refused (sizes, periods).
  bool above_min = false;
};

/// The parameters of one kind. Field names are unique.
struct FieldTable {
  std::vector<Field> fields;

  /// Position of a field, or -1.
  int find(std::string_view name) const;
  /// Every field at its default; required fields are left not given.
  Record defaults() const;
};

/// Key suffixes of a unit with the factor to SI, the SI one first: {"_rad", 1}, {"_deg", pi/180}.
struct UnitSuffix {
  std::string_view suffix;
  std::string_view symbol;  ///< for people: "rad", "deg", "m/s"
  double to_si;
};
std::span<const UnitSuffix> unit_suffixes(Unit unit);

/// The value of a field, by its name; the table must have it.
inline const Value& get(const FieldTable& table, const Record& record, std::string_view name) {
  return record[static_cast<std::size_t>(table.find(name))];
}

/// The fields x, y, z (m) and heading (rad), each 0 by default: how poses are written.
const FieldTable& pose_fields();

}  // namespace troupe::engine
