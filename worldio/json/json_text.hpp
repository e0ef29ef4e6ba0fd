#pragma once

#include "worldio/json/json_document.hpp"

#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace troupe::worldio {

/// Makes a node from a value, whose type must be one that a JsonNode can hold. `where` is the place that
/// later errors about the value name.
template <class T>
JsonNode json_node(T value, Where where = {}) {
  JsonNode node;
  node.value = std::move(value);
  node.where = where;
  return node;
}

/// Adds a key with a value, as json_node() makes it, at the end of an object.
template <class T>
void add_member(JsonNode::Object& object, std::string_view key, T value, Where where = {}) {
  object.push_back({std::string(key), where, json_node(std::move(value), where)});
}
/// Adds a key with a node at the end of an object. The key gets the place of the node.
inline void add_node(JsonNode::Object& object, std::string_view key, JsonNode node) {
  const Where where = node.where;
  object.push_back({std::string(key), where, std::move(node)});
}

/// Returns the list [x, y, ...] of these numbers.
JsonNode json_numbers(std::span<const double> numbers);

/// Returns a value as text on one line: `{"x_m": 1.5}`. Throws like json_text().
std::string json_line(const JsonNode& node);

/// Returns the document as readable text. A list or object that fits on one line is written on one line.
/// Numbers have the fewest digits that read back as the same double. Throws std::runtime_error for a number
/// that is not finite and for text that is not UTF-8, because JSON cannot represent these.
std::string json_text(const JsonNode& document);

}  // namespace troupe::worldio
