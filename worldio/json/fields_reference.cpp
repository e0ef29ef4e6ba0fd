#include "worldio/json/fields_reference.hpp"

#include "base/number_text.hpp"
#include "engine/spec/watch_spec.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/world_document.hpp"
#include "worldio/window_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <stdexcept>
#include <variant>

namespace troupe::worldio {
namespace {

constexpr std::string_view k_watch_heading = "### `watch{}`: printed time and speed";
constexpr std::string_view k_window_heading = "### `window{}`: the view of `--camera window`";

using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::Value;

/// Returns the spellings of a key, one for each unit, as Markdown.
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
  for (const Field& field : table.fields) {
    const KeyRow row = key_row(field);
    text += fmt::format("| {} | {} | {} | {} |\n", keys(field), row.value, row.usual, row.meaning);
  }
  text += '\n';
  for (const Field& field : table.fields) {
    if (!field.record || field.record == &engine::pose_fields())
      continue;  // poses have a table of their own at the beginning
    text += fmt::format("{} `{}` has these keys:\n\n",
                        field.type == FieldType::records ? "Each object in" : "The object", field.name);
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

// ---- the keys of the document

constexpr std::string_view k_table_head = "| key | value | default | meaning |\n|---|---|---|---|\n";

/// A table of keys in docs/world-format.md.
struct Section {
  std::string_view heading;
  std::string_view name;  ///< name of the objects, in references such as "as for `types`"
  const DocumentTable& (*table)();
  /// Which keys the table lists: all keys, those that objects of every kind may have, or those that only
  /// objects of some kinds may have (DocumentKey::is_of).
  enum class Of { all, every_kind, some_kinds } of = Of::all;
};

constexpr Section k_sections[] = {
    {"## Top level", "", document_table<WorldDocument>},
    {"### `record{}`", "record", document_table<RecordDocument>},
    {"### `arena{}`", "arena", document_table<ArenaDocument>},
    {"### `floorplans[]`", "floorplans", document_table<FloorplanDocument>},
    {"### `types{}`", "types", document_table<TypeDocument>},
    {"#### `blocks[]`", "blocks", document_table<BlockDocument>},
    {"#### `disc{}`", "disc", document_table<DiscDocument>},
    {"#### `drive{}`", "drive", document_table<DriveDocument>},
    {"#### `sensors[]` and `devices[]`", "devices", document_table<DeviceDocument>, Section::Of::every_kind},
    {"#### `sensors[]` and `devices[]`", "devices", document_table<DeviceDocument>, Section::Of::some_kinds},
    {"#### `controllers[]`", "controllers", document_table<ControllerDocument>},
    {"#### `parts[]`", "parts", document_table<PartDocument>},
    {"#### `ring{}`", "ring", document_table<RingDocument>},
    {"### `models[]`", "models", document_table<ModelDocument>},
    {"### `populations[]`", "populations", document_table<PopulationDocument>},
    {"#### `place{}`", "place", document_table<PlaceDocument>},
    {"### `measures[]`", "measures", document_table<MeasureDocument>},
    {"### `stop_when[]`", "stop_when", document_table<ConditionDocument>},
    {"### `at[]`", "at", document_table<InterventionDocument>},
    {"#### `remove{}`, `disable{}` and `enable{}`", "remove", document_table<GroupDocument>},
    {"#### `add{}`", "add", document_table<AddDocument>},
    {"#### `move{}`", "move", document_table<MoveDocument>},
    {"#### `set{}`", "set", document_table<SettingDocument>},
    {"### `faults[]`", "faults", document_table<FaultDocument>}};

/// Returns the anchor of a heading, with which a link refers to it: "watch-speed" for "### `watch{}`: speed".
std::string anchor(std::string_view heading) {
  std::string text;
  heading.remove_prefix(heading.find(' ') + 1);
  for (const char c : heading) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) || c == '-' || c == '_') text += static_cast<char>(std::tolower(byte));
    if (c == ' ') text += '-';
  }
  return text;
}

/// Returns the heading of the section of the page that describes the value of a key; empty if none does.
std::string_view heading_of(const DocumentKey& key) {
  if (key.block == &engine::watch_fields()) return k_watch_heading;
  if (key.block == &window_fields()) return k_window_heading;
  if (key.table == nullptr) return {};
  const DocumentTable* table = &key.table();
  if (table == &document_table<SensorDocument>()) table = &document_table<DeviceDocument>();
  for (const Section& section : k_sections)
    if (&section.table() == table) return section.heading;
  return {};
}

/// Turns the names of pages, such as docs/lives.md, into links.
std::string with_links(std::string_view text) {
  constexpr std::string_view k_folder = "docs/", k_end = ".md";
  std::string linked;
  while (true) {
    const std::size_t at = text.find(k_folder);
    const std::size_t end = at == text.npos ? at : text.find(k_end, at);
    if (end == text.npos) return linked += text;
    const std::string_view page =
        text.substr(at + k_folder.size(), end + k_end.size() - at - k_folder.size());
    linked += fmt::format("{}[{}]({})", text.substr(0, at), page, page);
    text.remove_prefix(end + k_end.size());
  }
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
  if (text.empty() && key.table != nullptr && heading_of(key).empty())
    for (const DocumentKey& inner : key.table().keys)
      text += fmt::format("{}`{}`: {}", text.empty() ? "" : "; ", inner.field.name, inner.field.text);
  if (key.other)
    text += fmt::format("; called `{}{}` for kinds with a parameter `{}`", key.other->name,
                        engine::unit_suffixes(key.other->unit).front().suffix, key.field.name);
  return text;
}

/// Returns the names of all faults, each with `mark` before and after it.
std::string fault_names(const engine::Registry& registry, std::string_view mark) {
  std::string names;
  for (const engine::FaultKind& fault : registry.faults)
    names += fmt::format("{}{}{}{}", names.empty() ? "" : ", ", mark, fault.name, mark);
  return names;
}

struct TableRow {
  std::string first_key;  ///< the first of its keys
  std::string text;       ///< the row as Markdown
};

TableRow row_of(const DocumentTable& table, const DocumentKey& key, std::string_view heading,
                const engine::Registry& registry) {
  std::string names;
  if (key.form == Form::heading)
    names = fmt::format("{}, `{}`", keys(heading_field()), key.field.name);
  else if (key.form == Form::faults)
    names = fault_names(registry, "`");
  else
    names = keys(key.field);
  const KeyRow row = key_row(table, key, registry);
  std::string meaning = with_links(row.meaning);
  if (const std::string_view below = heading_of(key); !below.empty() && below != heading)
    meaning += fmt::format("{}[below](#{})", meaning.empty() ? "" : ": ", anchor(below));
  return {names.substr(0, names.find(',')),
          fmt::format("| {} | {} | {} | {} |\n", names, row.value, with_links(row.usual), meaning)};
}

/// Appends the rows of a table. One row that refers to an earlier table replaces each group of `k_fewest` or
/// more consecutive rows that this earlier table also has.
void append_rows(const std::vector<TableRow>& rows, const std::map<std::string, const Section*>& earlier,
                 std::string& text) {
  constexpr std::size_t k_fewest = 3;
  const auto section_of = [&](std::size_t i) {
    const auto found = i < rows.size() ? earlier.find(rows[i].text) : earlier.end();
    return found == earlier.end() ? nullptr : found->second;
  };
  for (std::size_t i = 0; i < rows.size();) {
    const Section* section = section_of(i);
    std::size_t end = i + 1;
    while (section && section_of(end) == section) ++end;
    if (section && end - i >= k_fewest) {
      text += "| ";
      for (std::size_t k = i; k < end; ++k) text += fmt::format("{}{}", k > i ? ", " : "", rows[k].first_key);
      text += fmt::format(" | as for [`{}`](#{}) | | |\n", section->name, anchor(section->heading));
    } else {
      for (std::size_t k = i; k < end; ++k) text += rows[k].text;
    }
    i = end;
  }
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
  const std::string names = key.form == Form::faults ? fault_names(registry, {})
                            : key.form == Form::heading
                                ? fmt::format("{}, {}", key_text(heading_field()), key.field.name)
                                : key_text(key.field);
  return {names, form_text(key, key.field), default_text(table, key, key.field), meaning(table, key)};
}

KeyRow key_row(const Field& field) {
  return {key_text(field), what(field), value_text(field.fallback, field), std::string(field.text)};
}

std::string world_format_reference(const engine::Registry& registry) {
  std::string text = "### Poses\n\n";
  append_table(engine::pose_fields(), text);
  text += k_watch_heading;
  text += "\n\nThese keys do not change the results of a run.\n\n";
  append_table(engine::watch_fields(), text);
  text += k_window_heading;
  text +=
      "\n\n[pictures.md](pictures.md) describes this view. Each of the keys `show_grid`, `show_clock`, "
      "`show_footprints` and\n"
      "`show_occupancy` switches one layer of the view on or off. The keys `show_ranger_ranges`, "
      "`show_fiducial`,\n"
      "`show_gripper_data` and `blobfinder_vis` do the same, but only if `show_data` is true. `--layers` "
      "adds and removes\n"
      "layers. The other switches, `interval` and the keys of screenshots have no effect.\n\n";
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
      const Field& field = kind->params.at(name);
      text += fmt::format("| {} | {} |\n", keys(field), value_text(value, field));
    }
    text += '\n';
  }
  text.pop_back();  // the blank line after the last table
  return text;
}

std::vector<KeyTable> document_key_tables(const engine::Registry& registry) {
  std::vector<KeyTable> tables;
  std::map<std::string, const Section*> sections;  // per row: the first table that has it
  for (const Section& section : k_sections) {
    const DocumentTable& table = section.table();
    std::vector<TableRow> rows;
    for (const DocumentKey& key : table.keys)
      if (key.form != Form::parameters && (section.of == Section::Of::all ||
                                           (key.is_of != nullptr) == (section.of == Section::Of::some_kinds)))
        rows.push_back(row_of(table, key, section.heading, registry));
    std::string text(k_table_head);
    append_rows(rows, sections, text);
    for (const TableRow& row : rows) sections.emplace(row.text, &section);
    tables.push_back({section.heading, std::move(text)});
  }
  return tables;
}

std::string with_key_tables(const std::string& page, const std::vector<KeyTable>& tables) {
  std::string made = page;
  std::string_view heading;
  std::size_t at = 0;
  for (const KeyTable& table : tables) {
    if (table.heading != heading) {
      at = made.find(fmt::format("\n{}\n", table.heading));
      if (at == made.npos)
        throw std::runtime_error(
            fmt::format("the documentation page has no heading \"{}\": add this heading", table.heading));
      ++at;
    }
    heading = table.heading;
    const std::size_t next = made.find("\n#", at + (made[at] == '#' ? 1 : 0));
    const std::size_t begin = made.find("\n| key", at);
    if (begin >= next)
      throw std::runtime_error(
          fmt::format("the documentation page has too few tables below the heading \"{}\": add a table that "
                      "begins with \"| key\"",
                      heading));
    const std::size_t end = std::min(made.find("\n\n", begin), made.size() - 1);
    made.replace(begin + 1, end - begin, table.markdown);
    at = begin + 1 + table.markdown.size();
  }
  return made;
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
