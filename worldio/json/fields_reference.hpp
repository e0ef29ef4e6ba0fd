#pragma once

#include "engine/kinds/kinds.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {

struct DocumentKey;
struct DocumentTable;

/// Returns the key of a field, and in parentheses the endings of the other units that the key can have:
/// "pitch_m (_cm, _mm)".
std::string key_text(const engine::Field& field);

/// The description of a key of a JSON object, as plain text.
struct KeyRow {
  std::string names;    ///< the key, as key_text() returns it
  std::string value;    ///< allowed values: "number, above 0 m"
  std::string usual;    ///< default value, "none" or "required"
  std::string meaning;  ///< may be empty
};
/// Returns the description of the key `key`, which is one of the keys of `table`.
KeyRow key_row(const DocumentTable& table, const DocumentKey& key, const engine::Registry& registry);
/// Returns the description of a parameter of a kind, or of a field of another object.
KeyRow key_row(const engine::Field& field);

/// Returns the last part of docs/world-format.md as Markdown, which is generated. It has a table for poses,
/// for the object `watch` (printed time and speed), for the object `window` (a view of the world), and for
/// each kind (sort) of drive, sensor, other device, controller and fault in `registry`. Each row describes a
/// key or parameter: its spelling in each unit, the allowed values, the default and the meaning. There is
/// also a table for each preset, which is a kind of controller with other defaults. It lists only these other
/// defaults.
std::string world_format_reference(const engine::Registry& registry);

/// A table in docs/world-format.md that lists the keys of one kind of JSON object.
struct KeyTable {
  std::string_view heading;  ///< the line, with its "#" characters, of the heading above the table; several
                             ///< tables can share it
  std::string markdown;      ///< the lines of the table
};

/// Returns the tables of keys of docs/world-format.md, in the order of the page. They are made from the
/// tables of worldio/json/document_table.hpp. If three or more consecutive rows of a table are the same as in
/// an earlier table, a single row with a link to the earlier table replaces them.
std::vector<KeyTable> document_key_tables(const engine::Registry& registry);

/// Replaces tables of keys in the Markdown page `page` by `tables`, and returns the new page. A table of keys
/// is a table that begins with `| key`. Each of `tables` replaces a table below the heading that it names
/// (KeyTable::heading). If several of `tables` name the same heading, they must be consecutive, and replace
/// the tables below this heading in their order. Throws std::runtime_error if the page lacks a heading, or
/// has fewer tables of keys below it than `tables` has for this heading.
std::string with_key_tables(const std::string& page, const std::vector<KeyTable>& tables);

/// Returns the generated part of docs/measures.md as Markdown. A measure is a number that is computed from
/// the state of a run. The text lists all measures of `registry`, each with the name of its column in the
/// results, its definition, its formula if it has one, and its parameters.
std::string measures_reference(const engine::Registry& registry);

}  // namespace troupe::worldio
