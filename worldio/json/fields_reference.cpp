#include "worldio/json/fields_reference.hpp"

#include "base/number_text.hpp"
#include "engine/watch_spec.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/window_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

namespace troupe::worldio {
namespace {

using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::Value;

std::string keys(const Field& field) {
  std::string text;
  for (const engine::UnitSuffix& suffix : engine::unit_suffixes(field.unit))
    text += fmt::format("{}`{}{}`", text.empty() ? "" : ", ", field.name, suffix.suffix);
  return text;
}

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

void append_table(const FieldTable& table, std::string& text) {
  if (table.fields.empty()) {
    text += "No parameters.\n\n";
    return;
  }
  text += "| key | value | default | meaning |\n|---|---|---|---|\n";
  for (const Field& field : table.fields)
    text += fmt::format("| {} | {} | {} | {} |\n", keys(field), what(field),
                        value_text(field.fallback, field), field.text);
  text += '\n';
  for (const Field& field : table.fields) {
    if (!field.record || field.record == &engine::pose_fields())
      continue;  // poses have a table of their own at the beginning
    text += fmt::format("{} `{}`:\n\n", field.type == FieldType::records ? "Each of" : "In", field.name);
    append_table(*field.record, text);
  }
}

template <class Kinds>
void append_kinds(std::string_view heading, const Kinds& kinds, std::string& text) {
  for (const auto& kind : kinds) {
    text += fmt::format("### {} `{}`\n\n{}\n\n", heading, kind.name, kind.text);
    append_table(kind.params, text);
  }
}

}  // namespace

std::string world_format_reference(const engine::Registry& registry) {
  std::string text = "### Poses\n\n";
  append_table(engine::pose_fields(), text);
  text += "### `watch{}`: clock and pace\n\nThese keys do not change the results of a run.\n\n";
  append_table(engine::watch_fields(), text);
  text +=
      "### `window{}`: the view of `--camera window`\n\n[pictures.md](pictures.md) describes this view. It "
      "shows the layers `show_grid`, `show_clock`, `show_footprints` and `show_occupancy`; with `show_data`, "
      "also `show_ranger_ranges`, `show_fiducial`, `show_gripper_data` and `blobfinder_vis`. `--layers` adds "
      "and removes layers. The other switches, `interval` and the keys of screenshots have no effect.\n\n";
  append_table(window_fields(), text);
  append_kinds("Drive", registry.drives, text);
  append_kinds("Sensor", registry.sensors(), text);
  append_kinds("Device", registry.other_devices(), text);
  append_kinds("Controller", registry.controllers, text);
  append_kinds("Fault", registry.faults, text);
  for (const engine::Registry::Preset& preset : registry.presets) {
    text += fmt::format("### Controller `{}`\n\n{}: `{}` with other defaults.\n\n", preset.name, preset.text,
                        preset.kind);
    const engine::ControllerKind* kind = registry.controller(preset.kind);
    if (!kind || preset.params.empty()) continue;
    text += "| key | default |\n|---|---|\n";
    for (const auto& [name, value] : preset.params) {
      const Field& field = kind->params.fields[static_cast<std::size_t>(kind->params.find(name))];
      text += fmt::format("| {} | {} |\n", keys(field), value_text(value, field));
    }
    text += '\n';
  }
  text.pop_back();  // the blank line after the last table
  return text;
}

std::string measures_reference(const engine::Registry& registry) {
  std::string text = "| measure | column | what it is |\n|---|---|---|\n";
  for (const engine::MeasureKind& kind : registry.measures)
    text += fmt::format("| `{}` | `{}{}` | {} |\n", kind.name, kind.name,
                        engine::unit_suffixes(kind.unit).front().suffix, kind.text);
  for (const engine::MeasureKind& kind : registry.measures) {
    text += fmt::format("\n### `{}`\n\n{}\n", kind.name, kind.definition);
    if (!kind.formula.empty()) text += fmt::format("\n`{}`\n", kind.formula);
    if (kind.params.fields.empty()) continue;
    text += '\n';
    append_table(kind.params, text);
    text.pop_back();
  }
  return text;
}

}  // namespace troupe::worldio
