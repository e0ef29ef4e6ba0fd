#pragma once

#include "worldio/json/json_document.hpp"

#include <span>
#include <string>
#include <string_view>
#include <utility>

/// Makes JSON nodes and converts them to text. A JsonNode (worldio/json/json_node.hpp) is a JSON value with
/// its place (Where): the file and the line that are shown in error messages about the value. The default
/// Where() means that the value comes from no file.
namespace troupe::worldio {

/// Makes a node from a value and its place. T is one of the types of the variant JsonNode::value.
template <class T>
JsonNode json_node(T value, Where where = {}) {
  JsonNode node;
  node.value = std::move(value);
  node.where = where;
  return node;
}

/// Appends a key and its value to an object. T is one of the types of the variant JsonNode::value. The key
/// and the value both get the place `where`. The object must not have the key yet; this is not checked.
template <class T>
void add_member(JsonNode::Object& object, std::string_view key, T value, Where where = {}) {
  object.push_back({std::string(key), where, json_node(std::move(value), where)});
}
/// Appends a key and its value `node` to an object. The key gets the place of the node. The object must not
/// have the key yet; this is not checked.
inline void add_node(JsonNode::Object& object, std::string_view key, JsonNode node) {
  const Where where = node.where;
  object.push_back({std::string(key), where, std::move(node)});
}

/// Returns the list [x, y, ...] of these numbers.
JsonNode json_numbers(std::span<const double> numbers);

/// Returns a value as text on one line, without a line end: `{"x_m": 1.5}`. Throws the exceptions of
/// json_text().
std::string json_line(const JsonNode& node);

/// Returns a value as text with line breaks and indentation; the text ends with a line end. Each list or
/// object that fits into a line of 110 bytes is written on one line. Numbers have the fewest digits that read
/// back as the same double. Throws std::runtime_error for a number that is not finite and for text that is
/// not UTF-8, because JSON cannot represent them.
std::string json_text(const JsonNode& document);

}  // namespace troupe::worldio
