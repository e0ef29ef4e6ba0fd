#include "worldio/json/fields_json.hpp"

#include "base/number_text.hpp"
#include "engine/fields/description.hpp"
#include "worldio/colors.hpp"
#include "worldio/json/json_ring.hpp"
#include "worldio/json/json_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

namespace troupe::worldio {
namespace {

using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::Record;
using engine::Unit;
using engine::UnitSuffix;
using engine::Value;

std::string limit(double si, const UnitSuffix& suffix) { return plain_number(si / suffix.to_si); }

std::string with_symbol(std::string text, const UnitSuffix& suffix) {
  if (!suffix.symbol.empty()) text += fmt::format(" {}", suffix.symbol);
  return text;
}

std::string in_unit(std::string text, const UnitSuffix& suffix) {
  if (!suffix.symbol.empty()) text += fmt::format(" in {}", suffix.symbol);
  return text;
}

/// Returns the digits of a JSON number, without rounding.
std::string digits_of(const JsonNode& number) {
  return number.describe().substr(std::string_view("the number ").size());
}

/// Reports a number outside the limits of its field. If `unused` says why the field has no effect, this is a
/// warning, and the number may be used (FieldCondition).
bool may_exceed(const JsonCursor& at, const std::string& message, const std::string& unused) {
  if (unused.empty())
    at.error(message);
  else
    at.warning(fmt::format("{}; it has no effect, because {}", message, unused));
  return !unused.empty();
}

/// Reads a number that is written in the unit `suffix` and returns it in SI units. Empty, with an error, if
/// the value is not a number or is outside the limits of the field. unused: see may_exceed()
std::optional<double> read_number(const JsonCursor& at, const Field& field, const UnitSuffix& suffix,
                                  const std::string& unused = {}) {
  const std::optional<double> given = real_number_of(at.node());
  if (!given) {
    at.expected(in_unit("a number", suffix));
    return std::nullopt;
  }
  double si = *given * suffix.to_si;
  const bool is_whole = engine::has_whole_numbers(field);
  // A value exactly at a limit, such as 360 deg where the limit is 2 pi rad, must pass although its
  // conversion is rounded.
  const double rounding = is_whole ? 0 : 1e-14;
  if (si > field.max && si <= field.max + rounding * std::abs(field.max)) si = field.max;
  if (si < field.min && si >= field.min - rounding * std::abs(field.min)) si = field.min;
  const bool is_allowed =
      std::isfinite(si) && si >= field.min && si <= field.max && !(field.above_min && si == field.min);
  if (is_allowed && (!is_whole || std::trunc(si) == si)) return si;
  std::string limits = is_allowed ? "a whole number" : limits_text(field, suffix);
  if (limits.empty()) limits = "finite";
  const bool is_finite = std::isfinite(si) && std::abs(si) <= std::numeric_limits<float>::max();
  if (may_exceed(
          at,
          fmt::format("must be {}, found {}", limits, is_whole ? digits_of(at.node()) : exact_number(*given)),
          is_allowed || !is_finite ? "" : unused))
    return si;
  return std::nullopt;
}

Value read_integer(const JsonCursor& at, const Field& field, const std::string& unused) {
  const std::optional<std::int64_t> given = whole_number_of(at.node());
  const bool too_big = std::holds_alternative<std::uint64_t>(at.node().value);
  if (!given && !too_big) {
    at.expected("a whole number");
    return {};
  }
  const UnitSuffix bare{"", "", 1};
  const double x = given ? static_cast<double>(*given) : std::numeric_limits<double>::infinity();
  if (too_big || x < field.min || x > field.max || (field.above_min && x == field.min)) {
    const bool has_most = !too_big || std::isfinite(field.max);
    const std::string limits = has_most ? limits_text(field, bare) : "at most 2^63 - 1";
    if (!may_exceed(at, fmt::format("must be {}, found {}", limits, digits_of(at.node())),
                    too_big ? "" : unused))
      return {};
  }
  return *given;
}

Value read_text_field(const JsonCursor& at, const Field& field) {
  const std::string* text = at.node().text();
  if (!text) {
    at.expected(field.choices.empty() ? "a text" : fmt::format("one of {}", comma_list(field.choices)));
    return {};
  }
  if (!field.choices.empty() &&
      std::find(field.choices.begin(), field.choices.end(), *text) == field.choices.end()) {
    at.error(unknown_name(field.name, *text, field.choices));
    return {};
  }
  return *text;
}

Value read_numbers(const JsonCursor& at, const Field& field, const UnitSuffix& suffix,
                   const std::string& unused) {
  const JsonNode::List* list = at.node().list();
  if (!list || (field.columns > 0 && list->size() != field.columns)) {
    at.expected(
        in_unit(field.columns > 0 ? fmt::format("a list of {} numbers", field.columns) : "a list of numbers",
                suffix));
    return {};
  }
  std::vector<double> numbers;
  for (std::size_t i = 0; i < list->size(); ++i)
    if (const auto x = read_number(JsonCursor(at, i, (*list)[i]), field, suffix, unused))
      numbers.push_back(*x);
  if (numbers.size() < list->size()) return {};
  return numbers;
}

Value read_colors(const JsonCursor& at) {
  const JsonNode::List* list = read_list(at);
  if (!list) return {};
  std::vector<double> parts;
  for (std::size_t i = 0; i < list->size(); ++i)
    if (const auto color = read_color(JsonCursor(at, i, (*list)[i])))
      parts.insert(parts.end(), {color->r, color->g, color->b});
  if (parts.size() < 3 * list->size()) return {};
  return parts;
}

Value read_texts(const JsonCursor& at) {
  const JsonNode::List* list = read_list(at);
  if (!list) return {};
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < list->size(); ++i) {
    if (const std::string* text = (*list)[i].text())
      texts.push_back(*text);
    else
      JsonCursor(at, i, (*list)[i]).expected("a text");
  }
  if (texts.size() < list->size()) return {};
  return texts;
}

Record read_record(const JsonCursor& at, const FieldTable& table) {
  JsonObject object(at);
  Record record = read_fields(object, table);
  object.finish();
  return record;
}

/// Reads a list of records. A record with a pose may be given as a ring, which stands for several records.
Value read_records(const JsonCursor& at, const FieldTable& table) {
  const JsonNode::List* list = read_list(at);
  if (!list) return {};
  std::vector<Record> records;
  const bool has_poses = table.find("pose") >= 0;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const JsonCursor entry(at, i, (*list)[i]);
    if (!has_poses || !has_ring(entry.node())) {
      records.push_back(read_record(entry, table));
      continue;
    }
    const std::size_t before = at.diagnostics().findings().size();
    for (const JsonNode& copy : expand_ring(entry)) {
      records.push_back(read_record(JsonCursor(at, i, copy), table));
      if (at.diagnostics().findings().size() > before) break;  // the other copies have the same errors
    }
  }
  return records;
}

Value read_in_unit(const JsonCursor& at, const Field& field, const UnitSuffix& suffix,
                   const std::string& unused = {}) {
  switch (field.type) {
    case FieldType::boolean:
      if (const bool* x = std::get_if<bool>(&at.node().value)) return *x;
      at.expected("true or false");
      return {};
    case FieldType::integer: return read_integer(at, field, unused);
    case FieldType::number:
      if (const auto x = read_number(at, field, suffix, unused)) return *x;
      return {};
    case FieldType::text: return read_text_field(at, field);
    case FieldType::texts: return read_texts(at);
    case FieldType::numbers: return read_numbers(at, field, suffix, unused);
    case FieldType::color:
      if (const auto color = read_color(at))
        return std::vector<double>{color->r, color->g, color->b, color->a};
      return {};
    case FieldType::colors: return read_colors(at);
    case FieldType::record: return std::vector<Record>{read_record(at, *field.record)};
    case FieldType::records: return read_records(at, *field.record);
  }
  return {};
}

/// Returns `si` in another unit, as a number of at most nine digits that converts back to exactly `si`. Empty
/// if there is no such number.
std::optional<double> exactly_in(double si, const UnitSuffix& suffix) {
  std::array<char, 32> digits{};
  constexpr int k_digits = 9;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), si / suffix.to_si,
                                          std::chars_format::general, k_digits);
  double value = 0;
  std::from_chars(digits.data(), end, value);
  if (!same_bits(value * suffix.to_si, si)) return std::nullopt;
  return value;
}

/// Converts each number of a list with exactly_in(). Empty if the result is empty for any of them.
std::optional<std::vector<double>> exactly_in(std::span<const double> si, const UnitSuffix& suffix) {
  std::vector<double> values;
  for (const double x : si)
    if (const auto value = exactly_in(x, suffix)) values.push_back(*value);
  if (values.size() < si.size()) return std::nullopt;
  return values;
}

/// Whether values of this unit are written in degrees, which are more readable than radians.
bool has_degrees(Unit unit) {
  return unit == Unit::radians || unit == Unit::radians_per_second ||
         unit == Unit::radians_per_second_squared;
}

std::vector<std::pair<Color, std::string>> named_colors() {
  std::vector<std::pair<Color, std::string>> colors;
  const auto add = [&colors](std::string name) {
    if (const auto color = color_by_name(name)) colors.emplace_back(*color, std::move(name));
  };
  for (const std::string_view name : color_names()) add(std::string(name));
  for (int level = 0; level <= 100; ++level) add(fmt::format("gray{}", level));
  return colors;
}

JsonNode record_node(const Record& record, const FieldTable& table) {
  JsonNode::Object object;
  write_fields(record, table, object);
  return json_node(std::move(object));
}

JsonNode texts_node(const std::vector<std::string>& texts) {
  JsonNode::List list;
  for (const std::string& text : texts) list.push_back(json_node(text));
  return json_node(std::move(list));
}

Color color_of(const std::vector<double>& parts) {
  return {static_cast<float>(parts[0]), static_cast<float>(parts[1]), static_cast<float>(parts[2]),
          static_cast<float>(parts[3])};
}

JsonNode colors_node(const std::vector<double>& parts) {
  JsonNode::List list;
  for (std::size_t i = 0; i + 2 < parts.size(); i += 3)
    list.push_back(color_node({static_cast<float>(parts[i]), static_cast<float>(parts[i + 1]),
                               static_cast<float>(parts[i + 2]), 1}));
  return json_node(std::move(list));
}

bool same_records(const Record& a, const Record& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(),
                                            [](const Value& x, const Value& y) { return same_bits(x, y); });
}

}  // namespace

std::optional<double> real_number_of(const JsonNode& node) {
  if (const auto* x = std::get_if<double>(&node.value)) return *x;
  if (const auto* x = std::get_if<std::int64_t>(&node.value)) return static_cast<double>(*x);
  if (const auto* x = std::get_if<std::uint64_t>(&node.value)) return static_cast<double>(*x);
  return std::nullopt;
}

std::optional<std::int64_t> whole_number_of(const JsonNode& node) {
  constexpr double k_exact = 9007199254740992.0;  // 2^53: larger doubles are not exact integers
  if (const auto* x = std::get_if<std::int64_t>(&node.value)) return *x;
  if (const auto* x = std::get_if<double>(&node.value))
    if (*x == std::floor(*x) && std::abs(*x) <= k_exact) return static_cast<std::int64_t>(*x);
  return std::nullopt;
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool same_bits(const Pose& a, const Pose& b) {
  return same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.z, b.z) && same_bits(a.heading, b.heading);
}

bool same_bits(const Value& a, const Value& b) {
  if (a.v.index() != b.v.index()) return false;
  if (const auto* x = std::get_if<double>(&a.v)) return same_bits(*x, b.number());
  if (const auto* x = std::get_if<std::vector<double>>(&a.v))
    return x->size() == b.numbers().size() && std::equal(x->begin(), x->end(), b.numbers().begin(),
                                                         [](double p, double q) { return same_bits(p, q); });
  if (const auto* x = std::get_if<std::vector<Record>>(&a.v))
    return x->size() == b.records().size() &&
           std::equal(x->begin(), x->end(), b.records().begin(), same_records);
  return a == b;
}

void write_field(const Field& field, const Value& value, JsonNode::Object& object) {
  const auto suffixes = engine::unit_suffixes(field.unit);
  const auto key = [&](const UnitSuffix& suffix) { return fmt::format("{}{}", field.name, suffix.suffix); };
  const UnitSuffix& si = suffixes.front();
  const UnitSuffix& shown = has_degrees(field.unit) ? suffixes[1] : si;
  if (!value.given()) return;
  switch (field.type) {
    case FieldType::boolean: return add_member(object, key(si), value.boolean());
    case FieldType::integer: return add_member(object, key(si), value.integer());
    case FieldType::number:
      if (const auto x = exactly_in(value.number(), shown)) return add_member(object, key(shown), *x);
      return add_member(object, key(si), value.number());
    case FieldType::text: return add_member(object, key(si), value.text());
    case FieldType::numbers:
      if (const auto list = exactly_in(value.numbers(), shown))
        return add_node(object, key(shown), json_numbers(*list));
      return add_node(object, key(si), json_numbers(value.numbers()));
    case FieldType::texts: return add_node(object, key(si), texts_node(value.texts()));
    case FieldType::color: return add_node(object, key(si), color_node(color_of(value.numbers())));
    case FieldType::colors: return add_node(object, key(si), colors_node(value.numbers()));
    case FieldType::record:
      return add_node(object, key(si), record_node(value.records().front(), *field.record));
    case FieldType::records: break;
  }
  JsonNode::List list;
  for (const Record& record : value.records()) list.push_back(record_node(record, *field.record));
  add_member(object, key(si), std::move(list));
}

void write_fields(const Record& record, const FieldTable& table, JsonNode::Object& object) {
  const Record defaults = table.defaults();
  for (std::size_t i = 0; i < std::min(table.fields.size(), record.size()); ++i)
    if (!same_bits(record[i], defaults[i])) write_field(table.fields[i], record[i], object);
}

void write_parameters(const Record& record, const FieldTable& table, JsonNode::Object& object) {
  const Record defaults = table.defaults();
  const auto is_usual = [&](std::size_t i) {
    const Value& in_json = table.fields[i].in_json;
    return same_bits(record[i], in_json.given() ? in_json : defaults[i]);
  };
  for (std::size_t i = 0; i < std::min(table.fields.size(), record.size()); ++i) {
    const std::string_view mirror = table.fields[i].mirror;
    if (!is_usual(i) || (!mirror.empty() && !is_usual(static_cast<std::size_t>(table.find(mirror)))))
      write_field(table.fields[i], record[i], object);
  }
}

double short_number(float x) {
  std::array<char, 32> digits{};
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), x);
  double value = 0;
  std::from_chars(digits.data(), end, value);
  return static_cast<float>(value) == x ? value : static_cast<double>(x);
}

JsonNode color_node(const Color& color) {
  static const std::vector<std::pair<Color, std::string>> names = named_colors();
  const auto named = std::ranges::find(names, color, &std::pair<Color, std::string>::first);
  if (named != names.end()) return json_node(named->second);
  std::vector<double> parts{short_number(color.r), short_number(color.g), short_number(color.b)};
  if (color.a != 1) parts.push_back(short_number(color.a));
  return json_numbers(parts);
}

FoundField find_field(JsonObject& object, const Field& field, const std::string& unused) {
  FoundField found;
  if (!object.is_object()) return found;
  for (const UnitSuffix& suffix : engine::unit_suffixes(field.unit)) {
    const std::string key = std::string(field.name) + std::string(suffix.suffix);
    const JsonNode* node = object.find(key);
    if (!node) continue;
    const JsonCursor at(object.at(), key, *node);
    if (found.where)
      at.error(fmt::format("given twice, in different units: give only one of {}", quoted_keys(field)));
    else
      found.value = read_in_unit(at, field, suffix, unused);
    found.where = node->where;
  }
  if (field.unit == Unit::none) return found;
  for (const JsonMember& member : *object.at().node().object()) {
    if (member.key != field.name) continue;
    object.find(field.name);
    object.at().error_at(member.where,
                         fmt::format("\"{}\" needs its unit: write {}", field.name, quoted_keys(field)));
    found.where = member.where;
  }
  return found;
}

Value read_field(JsonObject& object, const Field& field) { return find_field(object, field).value; }

Value read_value(const JsonCursor& at, const Field& field) {
  return read_in_unit(at, field, engine::unit_suffixes(field.unit).front());
}

std::optional<Color> read_color(const JsonCursor& at) {
  if (const std::string* name = at.node().text()) {
    const std::optional<Color> color = color_by_name(*name);
    if (!color)
      at.error(fmt::format("unknown color \"{}\": give an X11 name or [r, g, b]{}", *name,
                           did_you_mean(*name, color_names())));
    return color;
  }
  const JsonNode::List* list = at.node().list();
  if (!list || list->size() < 3 || list->size() > 4) {
    at.expected("a color: an X11 name, [r, g, b] or [r, g, b, a]");
    return std::nullopt;
  }
  Color color;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const Value x = read_value(JsonCursor(at, i, (*list)[i]), {.name = "color", .min = 0, .max = 1});
    if (!x.given()) return std::nullopt;
    (i == 0 ? color.r : i == 1 ? color.g : i == 2 ? color.b : color.a) = static_cast<float>(x.number());
  }
  return color;
}

namespace {

/// Reads the fields of a table. Sets given[i] to whether the object has a value of field i.
Record read_given(JsonObject& object, const FieldTable& table,
                  std::span<const std::pair<std::string_view, Value>> presets, std::vector<bool>& given) {
  Record record = table.defaults();
  given.assign(table.fields.size(), false);
  for (const auto& [name, value] : presets)
    if (const int i = table.find(name); i >= 0) record[static_cast<std::size_t>(i)] = value;
  if (!object.is_object()) return record;
  const auto read = [&](std::size_t i, const std::string& unused) {
    const Field& field = table.fields[i];
    FoundField found = find_field(object, field, unused);
    given[i] = found.value.given();
    if (given[i])
      record[i] = std::move(found.value);
    else if (!found.where && !record[i].given() && !field.optional)
      object.at().error(fmt::format("missing {}: {}", quoted_keys(field), field.text));
  };
  // The fields with a condition come last, because the condition is on another field.
  const auto has_condition = [](const Field& field) { return !field.used_if.field.empty(); };
  for (std::size_t i = 0; i < table.fields.size(); ++i)
    if (!has_condition(table.fields[i])) read(i, {});
  for (std::size_t i = 0; i < table.fields.size(); ++i)
    if (const Field& field = table.fields[i]; has_condition(field))
      read(i, is_used(table, record, field) ? std::string() : unused_reason(table, record, field));
  return record;
}

}  // namespace

Record read_fields(JsonObject& object, const FieldTable& table,
                   std::span<const std::pair<std::string_view, Value>> presets) {
  std::vector<bool> given;
  return read_given(object, table, presets, given);
}

Record read_parameters(JsonObject& object, const FieldTable& table,
                       std::span<const std::pair<std::string_view, Value>> presets) {
  std::vector<bool> given;
  Record record = read_given(object, table, presets, given);
  for (std::size_t i = 0; i < table.fields.size(); ++i) {
    const Field& field = table.fields[i];
    if (given[i]) continue;
    if (field.in_json.given()) record[i] = field.in_json;
    if (field.mirror.empty()) continue;
    const auto other = static_cast<std::size_t>(table.find(field.mirror));
    if (given[other] && record[other].number() * field.fallback.number() < 0)
      record[i] = -record[other].number();
  }
  return record;
}

std::optional<engine::Record> read_block(JsonObject& object, std::string_view key,
                                         const engine::FieldTable& table) {
  const JsonNode* node = object.find(key);
  if (!node) return {};
  const JsonCursor at(object.at(), key, *node);
  JsonObject block(at);
  engine::Record record = read_fields(block, table);
  block.finish();
  return record;
}

std::string key_of(const Field& field) {
  return fmt::format("{}{}", field.name, engine::unit_suffixes(field.unit).front().suffix);
}

bool is_spelled(const Field& field, std::string_view key) {
  if (!key.starts_with(field.name)) return false;
  const std::string_view unit = key.substr(field.name.size());
  const auto suffixes = engine::unit_suffixes(field.unit);
  return unit.empty() || std::ranges::find(suffixes, unit, &UnitSuffix::suffix) != suffixes.end();
}

std::string quoted_keys(const Field& field) {
  std::string keys;
  const auto suffixes = engine::unit_suffixes(field.unit);
  for (std::size_t i = 0; i < suffixes.size(); ++i) {
    if (i > 0) keys += i + 1 == suffixes.size() ? " or " : ", ";
    keys += fmt::format("\"{}{}\"", field.name, suffixes[i].suffix);
  }
  return keys;
}

std::string limits_text(const Field& field, const UnitSuffix& suffix) {
  const bool low = std::isfinite(field.min);
  const bool high = std::isfinite(field.max);
  if (low && high && field.above_min)
    return with_symbol(
        fmt::format("above {} and at most {}", limit(field.min, suffix), limit(field.max, suffix)), suffix);
  if (low && high)
    return with_symbol(fmt::format("from {} to {}", limit(field.min, suffix), limit(field.max, suffix)),
                       suffix);
  if (low)
    return with_symbol(fmt::format("{} {}", field.above_min ? "above" : "at least", limit(field.min, suffix)),
                       suffix);
  if (high) return with_symbol(fmt::format("at most {}", limit(field.max, suffix)), suffix);
  return {};
}

}  // namespace troupe::worldio
