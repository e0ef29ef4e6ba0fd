#pragma once

#include "worldio/json/json_document.hpp"

#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace troupe::worldio {

/// Builds documents. Values are of the types that a JsonNode holds; `where` is the place of later errors
/// about them.
template <class T>
JsonNode json_node(T value, Where where = {}) {
  JsonNode node;
  node.value = std::move(value);
  node.where = where;
  return node;
}

template <class T>
void add_member(JsonNode::Object& object, std::string_view key, T value, Where where = {}) {
  object.push_back({std::string(key), where, json_node(std::move(value), where)});
}
inline void add_node(JsonNode::Object& object, std::string_view key, JsonNode node) {
  const Where where = node.where;
  object.push_back({std::string(key), where, std::move(node)});
}

/// [x, y, ...].
JsonNode json_numbers(std::span<const double> numbers);

/// A value on one line: `{"x_m": 1.5}`. Throws as json_text() does.
std::string json_line(const JsonNode& node);

/// The document as readable text: values that fit on a line are written on one, and numbers have the fewest
/// digits that read back as the same double. Throws std::runtime_error for a number that is not finite and
/// for text that is not UTF-8, which JSON cannot represent.
std::string json_text(const JsonNode& document);

}  // namespace troupe::worldio
