#pragma once

#include "engine/kinds/kinds.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// Returns the generated last part of docs/world-format.md as Markdown. The text has a table for poses, one
/// for each of the objects `watch` (speed of a run) and `window` (view of a run) of a world, and one for the
/// parameters of each kind (sort) of drive, sensor, other device, controller and fault in `registry`. Each
/// row of these tables gives a key in each of its units, the allowed values, the default and the meaning. For
/// each preset (a controller kind with other defaults, under a name of its own), a table lists only the
/// defaults that differ from those of the kind.
std::string world_format_reference(const engine::Registry& registry);

/// A table in docs/world-format.md that lists the keys of one kind of JSON object.
struct KeyTable {
  std::string_view heading;  ///< the line, with its "#" characters, of the heading above the table; several
                             ///< tables can share it
  std::string markdown;      ///< the lines of the table
};

/// Returns the tables of keys of docs/world-format.md, in the order of the page. The tables are made from the
/// descriptions (worldio/json/document_table.hpp) of the structs that hold the content of a JSON world. Three
/// or more consecutive keys that an earlier table describes in the same way share one row that refers to that
/// table.
std::vector<KeyTable> document_key_tables(const engine::Registry& registry);

/// Returns the text of a Markdown page with its tables of keys replaced by `tables`. Below each heading, the
/// first table of keys on the page is replaced by the first of `tables` with this heading, the second by the
/// second, and so on. `tables` with the same heading must follow one another. Throws std::runtime_error if
/// the page lacks a heading, or has too few tables below it.
std::string with_key_tables(const std::string& page, const std::vector<KeyTable>& tables);

/// Returns the generated part of docs/measures.md as Markdown. A measure is a number that is computed from
/// the state of a run. The text lists all measures of `registry`, each with the name of its column in the
/// results, its definition, its formula if it has one, and its parameters.
std::string measures_reference(const engine::Registry& registry);

}  // namespace troupe::worldio
