#include "engine/fields/description.hpp"

#include "base/diagnostics.hpp"
#include "base/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace troupe::engine {
namespace {

[[noreturn]] void contradicts(std::string_view name, const char* what) {
  throw std::logic_error("the description of \"" + std::string(name) + "\" " + what);
}

std::size_t offset_of(const void* object, const void* member) {
  return static_cast<std::size_t>(static_cast<const char*>(member) - static_cast<const char*>(object));
}

void* at(void* object, const Field& field) { return static_cast<char*>(object) + field.offset; }
const void* at(const void* object, const Field& field) {
  return static_cast<const char*>(object) + field.offset;
}

const MemberType& member_of(const Field& field) {
  if (field.member == nullptr) contradicts(field.name, "names no member of a struct that can be read or set");
  return *field.member;
}

void say(Field& field, const Fact& fact) {
  switch (fact.kind) {
    case Fact::Kind::text: field.text = fact.words; break;
    case Fact::Kind::unit: field.unit = fact.unit; break;
    case Fact::Kind::above:
    case Fact::Kind::at_least:
      if (fact.number > field.min) field.above_min = false;
      field.min = std::max(field.min, fact.number);
      if (fact.kind == Fact::Kind::above && fact.number == field.min)
        field.above_min = true;
      else if (fact.kind == Fact::Kind::at_least)
        field.max = std::min(field.max, fact.high);
      break;
    case Fact::Kind::at_most: field.max = std::min(field.max, fact.number); break;
    case Fact::Kind::choices: field.choices.assign(fact.choices.begin(), fact.choices.end()); break;
    case Fact::Kind::columns: field.columns = static_cast<std::size_t>(fact.number); break;
    case Fact::Kind::counts_readings: field.counts_readings = true; break;
    case Fact::Kind::fixed: field.fixed = true; break;
    case Fact::Kind::provenance: field.provenance = true; break;
    case Fact::Kind::sparse: field.sparse = true; break;
    case Fact::Kind::appearance: field.appearance = true; break;
    case Fact::Kind::used_if: field.used_if = {fact.words, fact.value, true}; break;
    case Fact::Kind::used_unless: field.used_if = {fact.words, fact.value, false}; break;
    case Fact::Kind::mirror: field.mirror = fact.words; break;
    case Fact::Kind::in_json:
      field.in_json = field.type == FieldType::boolean ? Value(fact.number != 0) : Value(fact.number);
      break;
    case Fact::Kind::required: break;
  }
}

/// Whether `record` has the default value of each field that has a default, that is, whose value in
/// `defaults` is given().
bool is_default(const Record& record, const Record& defaults) {
  for (std::size_t i = 0; i < defaults.size(); ++i)
    if (defaults[i].given() && record[i] != defaults[i]) return false;
  return true;
}

/// The default of a field: the value of its member in `example`, which is T{}. A member that is a struct gets
/// no default if all its members have the defaults of that struct's own table.
Value fallback_of(const Field& field, const void* example) {
  Value value = get(field, example);
  if (field.type == FieldType::record && field.record != nullptr && value.given() &&
      is_default(value.records().front(), field.record->defaults()))
    return {};
  return value;
}

}  // namespace

namespace detail {

Value numbers_value(const double* numbers, std::size_t count) {
  return std::vector<double>(numbers, numbers + count);
}

std::span<const double> numbers_of(const Value& value, std::size_t count) {
  const std::vector<double>& numbers = value.numbers();
  if (numbers.size() != count)
    throw std::invalid_argument("needs " + std::to_string(count) + " numbers, found " +
                                std::to_string(numbers.size()));
  return numbers;
}

std::int64_t integer_of(const Value& value, std::int64_t least, std::int64_t most) {
  const std::int64_t x = value.integer();
  if (x < least || x > most)
    throw std::invalid_argument("must be from " + std::to_string(least) + " to " + std::to_string(most) +
                                ", found " + std::to_string(x));
  return x;
}

void check_integer(double number, std::int64_t least, std::uint64_t most) {
  const std::uint64_t half = most / 2 + 1;           // `most` itself may not be a double
  const double end = 2 * static_cast<double>(half);  // the first number above the range
  if (!(number >= static_cast<double>(least) && number < end))
    throw std::invalid_argument("must be from " + std::to_string(least) + " to " + std::to_string(most) +
                                ", found " + plain_number(number));
  if (std::trunc(number) != number)
    throw std::invalid_argument("must be a whole number, found " + exact_number(number));
}

std::size_t choice_of(const Value& value, std::span<const std::string_view> choices) {
  const auto found = std::ranges::find(choices, value.text());
  if (found == choices.end())
    throw std::invalid_argument("must be one of " + comma_list(choices) + ", found \"" + value.text() + "\"");
  return static_cast<std::size_t>(found - choices.begin());
}

Value color_value(const Color& color) { return std::vector<double>{color.r, color.g, color.b, color.a}; }

void set_color(Color& color, const Value& value) {
  const std::span<const double> parts = numbers_of(value, 4);
  color = {static_cast<float>(parts[0]), static_cast<float>(parts[1]), static_cast<float>(parts[2]),
           static_cast<float>(parts[3])};
}

Value colors_value(const std::vector<Color>& colors) {
  std::vector<double> parts;
  for (const Color& color : colors) parts.insert(parts.end(), {color.r, color.g, color.b});
  return parts;
}

void set_colors(std::vector<Color>& colors, const Value& value) {
  const std::vector<double>& parts = value.numbers();
  colors.clear();
  for (std::size_t i = 0; i + 2 < parts.size(); i += 3)
    colors.push_back({static_cast<float>(parts[i]), static_cast<float>(parts[i + 1]),
                      static_cast<float>(parts[i + 2]), 1});
}

void add_field(FieldTable& table, std::string_view name, const MemberType& type, const void* object,
               const void* member, std::initializer_list<Fact> facts) {
  if (table.find(name) >= 0) contradicts(name, "gives this name to two members");
  Field field{.name = name, .type = type.type, .min = type.min, .max = type.max, .columns = type.columns};
  field.choices.assign(type.choices.begin(), type.choices.end());
  field.record = type.table != nullptr ? &type.table() : nullptr;
  field.optional = type.optional;
  field.member = &type;
  field.offset = offset_of(object, member);
  bool required = false;
  for (const Fact& fact : facts) {
    say(field, fact);
    required = required || fact.kind == Fact::Kind::required;
  }
  const bool is_number = field.type == FieldType::number || field.type == FieldType::numbers;
  if (field.unit != Unit::none && !is_number)
    contradicts(name, "gives a unit to a member that is not a number");
  const bool has_limits = field.min > type.min || field.max < type.max;
  if (has_limits &&
      (field.type == FieldType::boolean || field.type == FieldType::text || field.type == FieldType::texts))
    contradicts(name, "gives limits to a member without numbers");
  if (field.min > field.max) contradicts(name, "has a lower limit above its upper limit");
  if (field.choices.size() != type.choices.size() && field.type != FieldType::text)
    contradicts(name, "gives choices to a member that is not a text");
  if (field.counts_readings && field.type != FieldType::integer)
    contradicts(name, "counts readings with a member that is not an integer");
  if (field.columns != type.columns && (field.type != FieldType::numbers || type.columns > 0))
    contradicts(name, "contradicts the number of columns of its type");
  if (required && field.optional) contradicts(name, "makes an optional member required");
  if (required && field.type == FieldType::record)
    contradicts(name, "makes a record required, but records have defaults");
  Value fallback = fallback_of(field, object);
  if (field.optional && fallback.given()) contradicts(name, "gives a default to an optional member");
  if (!required) field.fallback = std::move(fallback);
  table.fields.push_back(std::move(field));
}

void add_apart(FieldTable& table, std::string_view name) {
  if (table.find(name) >= 0) contradicts(name, "gives this name to two members");
  table.fields.push_back({.name = name});
}

Value all_numbers(const MemberType& lists, const void* member) {
  std::vector<double> numbers;
  const std::size_t size = lists.size(member);
  for (std::size_t i = 0; i < size; ++i) {
    const Value list = lists.each->get(lists.block(const_cast<void*>(member), i));
    numbers.insert(numbers.end(), list.numbers().begin(), list.numbers().end());
  }
  return numbers;
}

void add_part(FieldTable& table, const FieldTable& part, const void* object, const void* member) {
  for (Field field : part.fields) {
    if (table.find(field.name) >= 0) contradicts(field.name, "gives this name to two members");
    if (field.fallback.given() || field.type == FieldType::record)
      field.fallback = fallback_of(field, member);
    field.offset += offset_of(object, member);
    table.fields.push_back(std::move(field));
  }
}

FieldTable described_table(void (*describe)(FieldTable& fields)) {
  FieldTable table;
  describe(table);
  return table;
}

}  // namespace detail

Value get(const Field& field, const void* object) {
  const MemberType& type = member_of(field);
  const void* member = at(object, field);
  if (type.get != nullptr) return type.get(member);
  std::vector<Record> records;
  const std::size_t size = type.size(member);
  if (size == 0 && type.optional) return {};
  records.reserve(size);
  for (std::size_t i = 0; i < size; ++i)  // block() takes a mutable pointer, but does not write
    records.push_back(record_of(*field.record, type.block(const_cast<void*>(member), i)));
  return records;
}

void set(const Field& field, void* object, const Value& value) {
  const MemberType& type = member_of(field);
  void* member = at(object, field);
  if (!value.given() && !type.optional) return;
  try {
    if (type.set != nullptr) return type.set(member, value);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("\"" + std::string(field.name) + "\" " + error.what());
  }
  const std::size_t size = value.given() ? value.records().size() : 0;
  if (type.resize != nullptr) {
    type.resize(member, 0);  // creates new structs: members that the records do not give have defaults
    type.resize(member, size);
  }
  for (std::size_t i = 0; i < std::min(size, type.size(member)); ++i)
    fill(*field.record, type.block(member, i), value.records()[i]);
}

Record record_of(const FieldTable& table, const void* object) {
  Record record;
  record.reserve(table.fields.size());
  for (const Field& field : table.fields) record.push_back(get(field, object));
  return record;
}

void fill(const FieldTable& table, void* object, const Record& record) {
  for (std::size_t i = 0; i < std::min(table.fields.size(), record.size()); ++i)
    if (record[i].given()) set(table.fields[i], object, record[i]);
}

std::vector<StateField> state_fields(const FieldTable& table) {
  std::vector<StateField> fields;
  for (const Field& field : table.fields) {
    const MemberType& member = member_of(field);
    StateField made;
    made.name = field.name;
    made.element = member.element;
    made.is_bool = member.is_bool;
    made.columns = static_cast<std::uint32_t>(std::max<std::size_t>(field.columns, 1));
    made.unit = unit_suffixes(field.unit).front().symbol;
    made.text = field.text;
    made.offset = static_cast<std::uint32_t>(field.offset);
    made.sparse = field.sparse;
    made.appearance = field.appearance;
    fields.push_back(std::move(made));
  }
  return fields;
}

}  // namespace troupe::engine
