#include "worldio/json/key_row.hpp"

#include "base/number_text.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/world_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <variant>
#include <vector>

namespace troupe::worldio {
namespace {

using engine::Field;
using engine::FieldType;
using engine::Value;

std::string what(const Field& field) {
  const std::string limits = limits_text(field, engine::unit_suffixes(field.unit).front());
  const auto within = [&](const std::string& noun) { return limits.empty() ? noun : noun + ", " + limits; };
  switch (field.type) {
    case FieldType::boolean: return "true or false";
    case FieldType::integer: return within("whole number");
    case FieldType::number: return within("number");
    case FieldType::numbers:
      return within(field.columns > 0 ? fmt::format("list of {} numbers", field.columns)
                                      : std::string("list of numbers"));
    case FieldType::text: return field.choices.empty() ? "text" : comma_list(field.choices);
    case FieldType::texts: return "list of texts";
    case FieldType::color: return "colour, an X11 name or [r, g, b]";
    case FieldType::colors: return "list of colours, each an X11 name or [r, g, b]";
    case FieldType::record: return "object";
    case FieldType::records: return "list of objects";
  }
  return {};
}

std::string value_text(const Value& value, const Field& field) {
  const std::string_view symbol = engine::unit_suffixes(field.unit).front().symbol;
  const std::string unit = symbol.empty() ? std::string() : fmt::format(" {}", symbol);
  if (const auto* x = std::get_if<bool>(&value.v)) return *x ? "true" : "false";
  if (const auto* x = std::get_if<std::int64_t>(&value.v)) return fmt::format("{}{}", *x, unit);
  if (const auto* x = std::get_if<double>(&value.v)) return fmt::format("{}{}", plain_number(*x, 6), unit);
  if (const auto* x = std::get_if<std::string>(&value.v)) return fmt::format("\"{}\"", *x);
  if (const auto* x = std::get_if<std::vector<double>>(&value.v)) {
    std::string numbers;
    for (const double number : *x) numbers += fmt::format("{}{:.6g}", numbers.empty() ? "" : ", ", number);
    return fmt::format("[{}]{}", numbers, x->empty() ? "" : unit);
  }
  if (const auto* x = std::get_if<std::vector<std::string>>(&value.v)) {
    std::string texts;
    for (const std::string& one : *x) texts += fmt::format("{}\"{}\"", texts.empty() ? "" : ", ", one);
    return fmt::format("[{}]", texts);
  }
  if (std::holds_alternative<std::vector<engine::Record>>(value.v) || field.optional) return "none";
  // A block may be absent if none of its fields is required. Its fields then have their defaults.
  const bool optional = field.type == FieldType::record &&
                        std::ranges::all_of(field.record->fields,
                                            [](const Field& f) { return f.fallback.given() || f.optional; });
  return optional ? "the defaults of its keys" : "required";
}

std::string form_text(const DocumentKey& key, const Field& field) {
  switch (key.form) {
    case Form::value: return what(field);
    case Form::choice: return comma_list(field.choices);
    case Form::version: return fmt::format("{}", k_format_version);
    case Form::seed: return "whole number, from 0 to 2^64 - 1";
    case Form::names: return "list of texts";
    case Form::color: return "colour";
    case Form::color_or_random: return "colour, or \"random\"";
    case Form::heading:
      return fmt::format("{}; `{}`: the text \"random\"", what(heading_field()), field.name);
    case Form::points: return "[[x, y], ...]";
    case Form::box: return "[[x_min, y_min], [x_max, y_max]]";
    case Form::contours: return "[[[x, y], ...], ...]";
    case Form::joint: return "text or null";
    case Form::comparison: return "text, as in `\">= 0.9\"`";
    case Form::list: return "list";
    case Form::map: return "object, whose keys are names";
    case Form::block:
    case Form::kept:
    case Form::faults:
    case Form::object: return "object";
    default: return "text";
  }
}

std::string default_text(const DocumentTable& table, const DocumentKey& key, const Field& field) {
  if (key.required) return "required";
  if (!key.by_default.empty()) return std::string(key.by_default);
  if (key.is_resolved || key.form == Form::kind || key.form == Form::faults) return "none";
  if (key.form == Form::value) {
    if (field.type == FieldType::record) return "the defaults of its keys";
    const Value value = engine::get(field, table.usual);
    return value.given() ? value_text(value, field) : "none";
  }
  const void* usual = key.find(table.usual);
  if (usual != nullptr && key.form == Form::choice)
    return fmt::format("\"{}\"", field.choices[*static_cast<const std::uint8_t*>(usual)]);
  if (usual != nullptr && key.form == Form::seed)
    return fmt::format("{}", *static_cast<const std::uint64_t*>(usual));
  return "none";
}

std::string meaning(const DocumentTable& table, const DocumentKey& key) {
  std::string text;
  if (key.variants != ~0u) {
    const auto& choices = table.find(table.variant)->field.choices;
    for (std::size_t i = 0; i < choices.size(); ++i)
      if ((key.variants >> i & 1) != 0) text += fmt::format("{}{}", text.empty() ? "" : ", ", choices[i]);
    text += ": ";
  }
  if (key.form == Form::kind)
    text += fmt::format("kind of the {}; the parameters of this kind are further keys", table.kinds->what);
  else if (key.form == Form::faults)
    text += "a kind of fault, with its parameters";
  else
    text += key.field.text;
  if (text.empty() && key.table != nullptr)
    for (const DocumentKey& inner : key.table().keys)
      text += fmt::format("{}`{}`: {}", text.empty() ? "" : "; ", inner.field.name, inner.field.text);
  if (key.other)
    text += fmt::format("; called `{}{}` for kinds with a parameter `{}`", key.other->name,
                        engine::unit_suffixes(key.other->unit).front().suffix, key.field.name);
  return text;
}

}  // namespace

std::string key_text(const Field& field) {
  const auto units = engine::unit_suffixes(field.unit);
  std::string others;
  for (const engine::UnitSuffix& unit : units.subspan(1))
    others += fmt::format("{}{}", others.empty() ? "" : ", ", unit.suffix);
  return fmt::format("{}{}{}", field.name, units.front().suffix, others.empty() ? "" : " (" + others + ")");
}

KeyRow key_row(const DocumentTable& table, const DocumentKey& key, const engine::Registry& registry) {
  const std::string names = key.form == Form::faults ? comma_list(name_list(registry.faults))
                            : key.form == Form::heading
                                ? fmt::format("{}, {}", key_text(heading_field()), key.field.name)
                                : key_text(key.field);
  return {names, form_text(key, key.field), default_text(table, key, key.field), meaning(table, key)};
}

std::string meaning_text(const Field& field) {
  if (field.mirror.empty()) return std::string(field.text);
  return fmt::format("{}; without it, minus `{}` if that is given and {} 0", field.text, field.mirror,
                     field.fallback.number() < 0 ? "above" : "below");
}

KeyRow key_row(const Field& field) {
  return {key_text(field), what(field),
          field.is_without_limit() ? "none" : value_text(field.usual_in_json(), field), meaning_text(field)};
}

}  // namespace troupe::worldio
