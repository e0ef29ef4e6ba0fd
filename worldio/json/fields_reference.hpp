#pragma once

#include "engine/kinds.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// Returns the generated part of docs/world-format.md as Markdown. It has a table for poses, for the objects
/// `watch` and `window` of a world, and for the parameters of each drive, sensor, other device, controller,
/// fault and controller preset. A table lists keys with their units, values with their limits, defaults and
/// meanings.
std::string world_format_reference(const engine::Registry& registry);

/// A table of docs/world-format.md with the keys of one kind of object of JSON worlds.
struct KeyTable {
  std::string_view heading;  ///< the heading line that the table is below; several tables can share it
  std::string markdown;      ///< the lines of the table
};

/// Returns the tables of keys of docs/world-format.md, in the order of the page. They are made from the
/// descriptions of the structs of a WorldDocument (worldio/json/document_table.hpp). Consecutive keys that
/// another table describes in the same way share one row, which refers to that table.
std::vector<KeyTable> document_key_tables(const engine::Registry& registry);

/// Returns the text of a Markdown page in which the tables replace those that the page has at their places:
/// below each heading, the first table of the page is replaced by the first of `tables` with this heading,
/// and so on. Throws std::runtime_error if the page has no such heading or no such table.
std::string with_key_tables(const std::string& page, const std::vector<KeyTable>& tables);

/// Returns the generated part of docs/measures.md as Markdown. It lists all measures, each with the name of
/// its column, its definition and its parameters.
std::string measures_reference(const engine::Registry& registry);

}  // namespace troupe::worldio
