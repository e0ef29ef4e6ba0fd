#pragma once

#include "base/diagnostics.hpp"
#include "worldio/json/json_node.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace troupe::worldio {

/// Reads a whole document. Empty, with errors, when the text is not JSON (RFC 8259), says a key twice in one
/// object, or nests deeper than 64 levels. Lines count from 1 in the file that `start` names; `start.line` is
/// ignored. With `fixed_place` every node gets `start` itself (values from the command line).
std::optional<JsonNode> parse_json(std::string_view text, Where start, bool fixed_place,
                                   Diagnostics& diagnostics);

/// `--set POINTER=VALUE`: replaces or adds the value at a JSON pointer (RFC 6901; `-` appends to a list). The
/// parent must exist. A value that is not JSON is a text. Errors, and later findings about the value, are
/// reported at `--set POINTER`.
void set_json_value(JsonNode& document, const std::string& pointer, const std::string& value,
                    Diagnostics& diagnostics);

/// Reports the keys that an object, or one below it, has twice.
void report_repeated_keys(const JsonNode& node, Diagnostics& diagnostics);
/// Places nodes that have no place: where what they are in is.
void place_nodes(JsonNode& node, const Where& around);

/// A pointer's token with `~` and `/` escaped.
std::string escape_pointer_token(std::string_view token);

}  // namespace troupe::worldio
