#pragma once

#include "base/diagnostics.hpp"
#include "worldio/json/json_node.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace troupe::worldio {

/// Parses a whole document. Empty, with errors, if the text is not JSON (RFC 8259), has a key twice in one
/// object, or nests deeper than 64 levels. Lines count from 1 in the file of `start`; `start.line` is
/// ignored. With `fixed_place`, every node gets `start` itself as its place (values from the command line).
std::optional<JsonNode> parse_json(std::string_view text, Where start, bool fixed_place,
                                   Diagnostics& diagnostics);

/// `--set POINTER=VALUE`: replaces or adds the value at a JSON pointer (RFC 6901; `-` appends to a list). The
/// parent must exist. A value that is not JSON is taken as a text. Errors, also later ones about the value,
/// are reported at `--set POINTER`.
void set_json_value(JsonNode& document, const std::string& pointer, const std::string& value,
                    Diagnostics& diagnostics);

/// Reports repeated keys of an object and of all objects below it.
void report_repeated_keys(const JsonNode& node, Diagnostics& diagnostics);
/// Gives nodes without a place that of their parent, the root that of `around`. Keys get the places of their
/// values.
void place_nodes(JsonNode& node, const Where& around);

/// A token of a JSON pointer with `~` and `/` escaped.
std::string escape_pointer_token(std::string_view token);

}  // namespace troupe::worldio
