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

/// One value of a JSON document and the place where it begins. nlohmann::json is not kept as the tree because
/// it knows no lines.
struct JsonNode {
  using List = std::vector<JsonNode>;      ///< in file order
  using Object = std::vector<JsonMember>;  ///< in file order, keys unique

  std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string, List, Object>
      value;    ///< nothing: null
  Where where;  ///< where it begins

  /// Null where it is something else.
  ///@{
  const List* list() const { return std::get_if<List>(&value); }
  const Object* object() const { return std::get_if<Object>(&value); }
  const std::string* text() const { return std::get_if<std::string>(&value); }
  ///@}
  /// The member of this key, or null; null too where this is no object.
  const JsonNode* find(std::string_view key) const;
  /// The same.
  JsonNode* find(std::string_view key) { return const_cast<JsonNode*>(std::as_const(*this).find(key)); }
  /// For messages: `a number`, `the text "abc"`, `a list`, ...
  std::string describe() const;
};

/// A key of an object and its value.
struct JsonMember {
  std::string key;  ///< without quotes and escapes
  Where where;      ///< of the key
  JsonNode node;    ///< the value
};

}  // namespace troupe::worldio
