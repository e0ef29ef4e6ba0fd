// The generated parts of docs/world-format.md and docs/measures.md.
#pragma once

#include "engine/kinds/registry.hpp"
#include "engine/spec/watch_spec.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/key_row.hpp"
#include "worldio/json/world_document.hpp"
#include "worldio/window_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio::reference_pages {

using engine::Field;
using engine::FieldTable;
using engine::FieldType;

constexpr std::string_view k_watch_heading = "### `watch{}`: printed time and speed";
constexpr std::string_view k_window_heading = "### `window{}`: the view of `--camera window`";
constexpr std::string_view k_table_head = "| key | value | default | meaning |\n|---|---|---|---|\n";

/// Returns the spellings of a key, one for each unit, as Markdown.
inline std::string keys(const Field& field) {
  std::string text;
  for (const engine::UnitSuffix& suffix : engine::unit_suffixes(field.unit))
    text += fmt::format("{}`{}{}`", text.empty() ? "" : ", ", field.name, suffix.suffix);
  return text;
}

inline void append_table(const FieldTable& table, std::string& text) {
  if (table.fields.empty()) {
    text += "No parameters.\n\n";
    return;
  }
  text += k_table_head;
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
inline void append_kinds(std::string_view heading, const Kinds& kinds, std::string& text) {
  for (const auto& kind : kinds) {
    text += fmt::format("### {} `{}`\n\n{}\n\n", heading, kind.name, kind.text);
    append_table(kind.params, text);
  }
}

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
inline std::string anchor(std::string_view heading) {
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
inline std::string_view heading_of(const DocumentKey& key) {
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
inline std::string with_links(std::string_view text) {
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

struct TableRow {
  std::string first_key;  ///< the first of its keys
  std::string text;       ///< the row as Markdown
};

inline TableRow row_of(const DocumentTable& table, const DocumentKey& key, std::string_view heading,
                       const engine::Registry& registry) {
  std::string names;
  if (key.form == Form::heading)
    names = fmt::format("{}, `{}`", keys(heading_field()), key.field.name);
  else if (key.form == Form::faults)
    for (const engine::FaultKind& fault : registry.faults)
      names += fmt::format("{}`{}`", names.empty() ? "" : ", ", fault.name);
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
inline void append_rows(const std::vector<TableRow>& rows,
                        const std::map<std::string, const Section*>& earlier, std::string& text) {
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

/// Returns the last part of docs/world-format.md as Markdown, which is generated. It has a table for poses,
/// for the object `watch` (printed time and speed), for the object `window` (a view of the world), and for
/// each kind (sort) of drive, sensor, other device, controller and fault in `registry`. Each row describes a
/// key or parameter: its spelling in each unit, the allowed values, the default and the meaning. There is
/// also a table for each preset, which is a kind of controller with other defaults. It lists only these other
/// defaults.
inline std::string world_format_reference(const engine::Registry& registry) {
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
      Field field = kind->params.at(name);
      field.fallback = value;
      text += fmt::format("| {} | {} |\n", keys(field), key_row(field).usual);
    }
    text += '\n';
  }
  text.pop_back();  // the blank line after the last table
  return text;
}

/// A table in docs/world-format.md that lists the keys of one kind of JSON object.
struct KeyTable {
  std::string_view heading;  ///< the line, with its "#" characters, of the heading above the table; several
                             ///< tables can share it
  std::string markdown;      ///< the lines of the table
};

/// Returns the tables of keys of docs/world-format.md, in the order of the page. They are made from the
/// tables of worldio/json/document_table.hpp. If three or more consecutive rows of a table are the same as in
/// an earlier table, a single row with a link to the earlier table replaces them.
inline std::vector<KeyTable> document_key_tables(const engine::Registry& registry) {
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

/// Replaces tables of keys in the Markdown page `page` by `tables`, and returns the new page. A table of keys
/// is a table that begins with `| key`. Each of `tables` replaces a table below the heading that it names
/// (KeyTable::heading). If several of `tables` name the same heading, they must be consecutive, and replace
/// the tables below this heading in their order. Throws std::runtime_error if the page lacks a heading, or
/// has fewer tables of keys below it than `tables` has for this heading.
inline std::string with_key_tables(const std::string& page, const std::vector<KeyTable>& tables) {
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

/// Returns the generated part of docs/measures.md as Markdown. A measure is a number that is computed from
/// the state of a run. The text lists all measures of `registry`, each with the name of its column in the
/// results, its definition, its formula if it has one, and its parameters.
inline std::string measures_reference(const engine::Registry& registry) {
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

}  // namespace troupe::worldio::reference_pages
