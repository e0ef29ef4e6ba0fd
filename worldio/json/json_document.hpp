#pragma once

#include "base/diagnostics.hpp"
#include "worldio/json/json_node.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace troupe::worldio {

/// Parses a whole JSON document. If the text is not JSON (RFC 8259), repeats a key in one object, has a
/// number that is too large for a double, or is nested deeper than 64 levels, reports errors and returns
/// nothing. Every node (a JSON value) gets its place, a Where: the file of `start`, and the line of the node
/// in `text`, counted from 1. With `fixed_place`, every node gets `start` as its place instead; this is for
/// text without lines of its own, such as a value from the command line.
std::optional<JsonNode> parse_json(std::string_view text, Where start, bool fixed_place,
                                   Diagnostics& diagnostics);

/// Applies the option `--set POINTER=VALUE` of the command line to a document: replaces or adds the value at
/// a JSON pointer (RFC 6901; `-`, or an index equal to the length, appends to a list). The object or list
/// that contains the value must exist. A value that is not JSON is taken as a text. Errors are reported at
/// the place `--set POINTER`, which also becomes the place of the value for later errors. After an error, the
/// document is unchanged.
void set_json_value(JsonNode& document, const std::string& pointer, const std::string& value,
                    Diagnostics& diagnostics);

/// Reports an error for every repeated key of an object. Checks `node` and all objects inside it.
void report_repeated_keys(const JsonNode& node, Diagnostics& diagnostics);
/// Gives a place to `node`, and to every node inside it, if the present place has no file (Where::k_no_file).
/// `node` gets `around`; every other such node gets the place of the node that contains it. All keys get the
/// places of their values.
void place_nodes(JsonNode& node, const Where& around);

/// Returns the tokens of a JSON pointer, unescaped. Empty if it is malformed or points to the root.
std::optional<std::vector<std::string>> pointer_tokens(const std::string& pointer);
/// Returns a key as a token of a JSON pointer: `~` becomes `~0`, `/` becomes `~1`.
std::string escape_pointer_token(std::string_view token);

}  // namespace troupe::worldio
