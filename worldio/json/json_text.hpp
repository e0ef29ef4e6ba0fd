#pragma once

#include "worldio/json/json_document.hpp"

#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace troupe::worldio {

/// Makes a node from a value of one of the types of JsonNode::value. Errors that are found later in the value
/// are reported at `where`.
template <class T>
JsonNode json_node(T value, Where where = {}) {
  JsonNode node;
  node.value = std::move(value);
  node.where = where;
  return node;
}

/// Adds a key and a value at the end of an object. The value must be of one of the types of JsonNode::value,
/// and the key and the value get the place `where`. The object must not have the key; this is not checked.
template <class T>
void add_member(JsonNode::Object& object, std::string_view key, T value, Where where = {}) {
  object.push_back({std::string(key), where, json_node(std::move(value), where)});
}
/// Adds a key with a node as its value at the end of an object, which must not have the key. The key gets the
/// place of the node.
inline void add_node(JsonNode::Object& object, std::string_view key, JsonNode node) {
  const Where where = node.where;
  object.push_back({std::string(key), where, std::move(node)});
}

/// Returns the list [x, y, ...] of these numbers.
JsonNode json_numbers(std::span<const double> numbers);

/// Returns a value as text on one line, without a line end: `{"x_m": 1.5}`. Throws std::runtime_error as
/// json_text() does.
std::string json_line(const JsonNode& node);

/// Returns the document as readable text that ends with a line end. A list or object that fits on one line of
/// 110 bytes is written on one line. Numbers have the fewest digits that read back as the same double. Throws
/// std::runtime_error for a number that is not finite and for text that is not UTF-8, because JSON cannot
/// represent these.
std::string json_text(const JsonNode& document);

}  // namespace troupe::worldio
