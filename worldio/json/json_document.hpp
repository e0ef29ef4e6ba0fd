#pragma once

#include "base/diagnostics.hpp"
#include "worldio/json/json_node.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace troupe::worldio {

/// Parses a whole JSON document. Reports errors, and returns nothing, if the text
/// - is not JSON (RFC 8259),
/// - repeats a key in one object,
/// - has a number that is too large for a double,
/// - is nested deeper than 64 levels.
///
/// Every node (JSON value) stores its place: the file of `start`, and the line of the node in `text`, counted
/// from 1. If `fixed_place` is true, the place of every node is `start`. This is for a text that is not from
/// a file, such as a value from the command line.
std::optional<JsonNode> parse_json(std::string_view text, Where start, bool fixed_place,
                                   Diagnostics& diagnostics);

/// Sets a value of a document, as the option `--set POINTER=VALUE` of the command line does. `pointer` is a
/// JSON pointer (RFC 6901). If the last token of the pointer is a new key of an object, this key is added. If
/// it is `-` or the length of a list, the value is appended to the list. A `value` that is not JSON is taken
/// as a text, but if it begins with { or [, this is an error. If the pointer is malformed, or if the object
/// or list that would contain the value does not exist, reports an error too. After an error the document is
/// unchanged. The place of these errors is the text `--set POINTER`. Later errors about the new value have
/// the same place.
void set_json_value(JsonNode& document, const std::string& pointer, const std::string& value,
                    Diagnostics& diagnostics);

/// Reports an error for every repeated key of an object. Checks `node` and all objects inside it.
void report_repeated_keys(const JsonNode& node, Diagnostics& diagnostics);
/// Gives a place to each node in the tree that begins at `node`, if the node has no place yet (its file is
/// Where::k_no_file). The node `node` gets `around`; any other node gets the place of the node that contains
/// it. Every key gets the place of its value, even if it had a place before.
void place_nodes(JsonNode& node, const Where& around);

/// Returns the tokens of a JSON pointer, unescaped: `/a/b~1c` has the tokens `a` and `b/c`. Returns nothing
/// if the pointer is malformed, and for the empty pointer, which means the whole document.
std::optional<std::vector<std::string>> pointer_tokens(const std::string& pointer);
/// Returns a key as a token of a JSON pointer: `~` becomes `~0`, `/` becomes `~1`.
std::string escape_pointer_token(std::string_view token);

}  // namespace troupe::worldio
