#pragma once

#include "base/diagnostics.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace troupe::worldio {

struct JsonMember;

/// One value of a JSON document (a node), with the values inside it, and the place where it begins. A
/// nlohmann::json tree would not keep line numbers.
struct JsonNode {
  using List = std::vector<JsonNode>;      ///< entries in file order
  using Object = std::vector<JsonMember>;  ///< members in file order; keys are unique after parse_json()

  std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string, List, Object>
      value;    ///< the value; std::monostate is null
  Where where;  ///< where the value begins

  /// Returns a pointer to the value if it is a list (list()), an object (object()) or a text (text()), else
  /// null.
  ///@{
  const List* list() const { return std::get_if<List>(&value); }
  const Object* object() const { return std::get_if<Object>(&value); }
  const std::string* text() const { return std::get_if<std::string>(&value); }
  ///@}
  /// Returns the value of a key, or a null pointer if there is no such key or if this node is not an object.
  ///@{
  const JsonNode* find(std::string_view key) const;
  JsonNode* find(std::string_view key) { return const_cast<JsonNode*>(std::as_const(*this).find(key)); }
  ///@}
  /// Describes the value, for messages: `the number 3`, `the text "abc"`, `a list of length 2`, `an object`,
  /// `null`, ...
  std::string describe() const;
};

/// A key of an object and its value.
struct JsonMember {
  std::string key;  ///< unquoted and unescaped
  Where where;      ///< where the key begins
  JsonNode node;    ///< the value
};

}  // namespace troupe::worldio
