#pragma once

#include "base/diagnostics.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace troupe::worldio {

struct JsonMember;

/// One value of a JSON document and the place where it begins. nlohmann::json is not kept as the tree because
/// it knows no lines.
struct JsonNode {
  using List = std::vector<JsonNode>;
  using Object = std::vector<JsonMember>;  // in file order, keys unique

  std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string, List, Object> value;
  Where where;

  const List* list() const { return std::get_if<List>(&value); }
  const Object* object() const { return std::get_if<Object>(&value); }
  const std::string* text() const { return std::get_if<std::string>(&value); }
  /// The member of this key, or null; null too where this is no object.
  const JsonNode* find(std::string_view key) const;
  JsonNode* find(std::string_view key) { return const_cast<JsonNode*>(std::as_const(*this).find(key)); }
  /// For messages: `a number`, `the text "abc"`, `a list`, ...
  std::string describe() const;
};

struct JsonMember {
  std::string key;
  Where where;  ///< of the key
  JsonNode node;
};

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
