#include "engine/fields/fields.hpp"

#include "base/math.hpp"
#include "base/number_text.hpp"
#include "engine/fields/description.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

namespace troupe::engine {

Value::Value() = default;
Value::Value(const Value&) = default;
Value::Value(Value&&) noexcept = default;
Value& Value::operator=(const Value&) = default;
Value& Value::operator=(Value&&) noexcept = default;
Value::~Value() = default;

Value::Value(bool x) : v(x) {}
Value::Value(int x) : v(std::int64_t{x}) {}
Value::Value(std::int64_t x) : v(x) {}
Value::Value(double x) : v(x) {}
Value::Value(const char* x) : v(std::string(x)) {}
Value::Value(std::string x) : v(std::move(x)) {}
Value::Value(std::vector<double> x) : v(std::move(x)) {}
Value::Value(std::vector<Record> x) : v(std::move(x)) {}
Value::Value(std::vector<std::string> x) : v(std::move(x)) {}

bool operator==(const Value& a, const Value& b) { return a.v == b.v; }

int FieldTable::find(std::string_view name) const {
  for (std::size_t i = 0; i < fields.size(); ++i)
    if (fields[i].name == name) return static_cast<int>(i);
  return -1;
}

Record FieldTable::defaults() const {
  Record record;
  record.reserve(fields.size());
  for (const Field& field : fields) {
    if (field.type == FieldType::record && !field.optional && !field.fallback.given())
      record.emplace_back(std::vector<Record>{field.record->defaults()});
    else
      record.push_back(field.fallback);
  }
  return record;
}

std::span<const UnitSuffix> unit_suffixes(Unit unit) {
  constexpr double k_deg = k_pi / 180.0;
  static constexpr std::array<UnitSuffix, 3> meters{
      {{"_m", "m", 1}, {"_cm", "cm", 0.01}, {"_mm", "mm", 0.001}}};
  static constexpr std::array<UnitSuffix, 2> angle{{{"_rad", "rad", 1}, {"_deg", "deg", k_deg}}};
  static constexpr std::array<UnitSuffix, 2> seconds{{{"_s", "s", 1}, {"_ms", "ms", 0.001}}};
  static constexpr std::array<UnitSuffix, 1> speed{{{"_mps", "m/s", 1}}};
  static constexpr std::array<UnitSuffix, 2> turn{{{"_radps", "rad/s", 1}, {"_degps", "deg/s", k_deg}}};
  static constexpr std::array<UnitSuffix, 1> acceleration{{{"_mps2", "m/s^2", 1}}};
  static constexpr std::array<UnitSuffix, 2> turn_acceleration{
      {{"_radps2", "rad/s^2", 1}, {"_degps2", "deg/s^2", k_deg}}};
  static constexpr std::array<UnitSuffix, 1> rate{{{"_per_s", "1/s", 1}}};
  static constexpr std::array<UnitSuffix, 2> mass{{{"_kg", "kg", 1}, {"_g", "g", 0.001}}};
  static constexpr std::array<UnitSuffix, 2> energy{{{"_J", "J", 1}, {"_kJ", "kJ", 1000}}};
  static constexpr std::array<UnitSuffix, 1> power{{{"_W", "W", 1}}};
  static constexpr std::array<UnitSuffix, 1> bare{{{"", "", 1}}};
  switch (unit) {
    case Unit::meters: return meters;
    case Unit::radians: return angle;
    case Unit::seconds: return seconds;
    case Unit::meters_per_second: return speed;
    case Unit::radians_per_second: return turn;
    case Unit::meters_per_second_squared: return acceleration;
    case Unit::radians_per_second_squared: return turn_acceleration;
    case Unit::per_second: return rate;
    case Unit::kilograms: return mass;
    case Unit::joules: return energy;
    case Unit::watts: return power;
    case Unit::none: break;
  }
  return bare;
}

std::vector<Unit> all_units() {
  std::vector<Unit> units;
  for (auto unit = Unit::meters; unit <= Unit::watts; unit = static_cast<Unit>(static_cast<int>(unit) + 1))
    units.push_back(unit);
  return units;
}

namespace {

/// Returns a value as FieldCondition::value writes it; empty for a value that no condition has.
std::string condition_text(const Value& value) {
  if (const auto* x = std::get_if<bool>(&value.v)) return *x ? "true" : "false";
  if (const auto* x = std::get_if<std::int64_t>(&value.v)) return std::to_string(*x);
  if (const auto* x = std::get_if<std::string>(&value.v)) return *x;
  return {};
}

/// Checks a number against the limits of a field.
Result<> check_number(const Field& field, double x) {
  const std::string_view symbol = unit_suffixes(field.unit).front().symbol;
  const auto refuse = [&](std::string_view limit, double bound) {
    return Error{fmt::format("\"{}\" must be {} {}{}{}, found {}", field.name, limit, plain_number(bound),
                             symbol.empty() ? "" : " ", symbol, plain_number(x))};
  };
  if (field.above_min && !(x > field.min)) return refuse("above", field.min);
  if (!(x >= field.min)) return refuse("at least", field.min);
  if (!(x <= field.max)) return refuse("at most", field.max);
  return {};
}

}  // namespace

bool is_used(const FieldTable& table, const Record& record, const Field& field) {
  const int other = field.used_if.field.empty() ? -1 : table.find(field.used_if.field);
  if (other < 0 || !record[static_cast<std::size_t>(other)].given()) return true;
  const bool is = condition_text(record[static_cast<std::size_t>(other)]) == field.used_if.value;
  return is == field.used_if.is;
}

std::string unused_reason(const FieldTable& table, const Record& record, const Field& field) {
  const std::string value = condition_text(get(table, record, field.used_if.field));
  const bool is_text = table.at(field.used_if.field).type == FieldType::text;
  return fmt::format("\"{}\" is {}", field.used_if.field, is_text ? '"' + value + '"' : value);
}

Result<> check_used(const FieldTable& table, const Record& record) {
  for (std::size_t i = 0; i < table.fields.size(); ++i) {
    const Field& field = table.fields[i];
    const Value& value = record[i];
    if (!value.given()) continue;
    if (const auto* blocks = std::get_if<std::vector<Record>>(&value.v); blocks && field.record)
      for (const Record& block : *blocks)
        if (const Result<> checked = check_used(*field.record, block); !checked) return checked.error();
    if (field.used_if.field.empty() || value == field.fallback || !is_used(table, record, field)) continue;
    std::vector<double> numbers;
    if (const auto* x = std::get_if<double>(&value.v)) numbers = {*x};
    if (const auto* x = std::get_if<std::int64_t>(&value.v)) numbers = {static_cast<double>(*x)};
    if (const auto* x = std::get_if<std::vector<double>>(&value.v)) numbers = *x;
    for (const double number : numbers)
      if (const Result<> checked = check_number(field, number); !checked) return checked.error();
  }
  return {};
}

const FieldTable& pose_fields() { return described<Pose>(); }

}  // namespace troupe::engine
