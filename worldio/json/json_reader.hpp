#pragma once

#include "base/diagnostics.hpp"
#include "worldio/json/json_document.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// A value being read and how it was reached. A cursor: it lives on the stack and points at its parent's, so
/// that the JSON pointer is spelt only when something is reported.
class JsonCursor {
 public:
  JsonCursor(const JsonNode& root, Diagnostics& diagnostics) : node_(&root), diagnostics_(&diagnostics) {}
  JsonCursor(const JsonCursor& parent, std::string_view key, const JsonNode& node)
      : parent_(&parent), key_(key), node_(&node), diagnostics_(parent.diagnostics_) {}
  JsonCursor(const JsonCursor& parent, std::size_t index, const JsonNode& node)
      : parent_(&parent), index_(index), node_(&node), diagnostics_(parent.diagnostics_) {}

  const JsonNode& node() const { return *node_; }
  Where where() const { return node_->where; }
  Diagnostics& diagnostics() const { return *diagnostics_; }
  /// `/robots/3/drive`; empty for the document itself.
  std::string pointer() const;
  /// Reports at this value: `/robots/3/drive: message`.
  void error(const std::string& message) const { error_at(where(), message); }
  void error_at(Where where, const std::string& message) const;
  /// Reports `expected WHAT, found ...`.
  void expected(std::string_view what) const;

 private:
  const JsonCursor* parent_ = nullptr;
  std::string_view key_;
  std::size_t index_ = 0;
  const JsonNode* node_;
  Diagnostics* diagnostics_;
};

/// Reads an object key by key, remembering which keys it knows, so that finish() reports the others.
class JsonObject {
 public:
  /// Reports where the value is no object; every find() is then empty.
  explicit JsonObject(const JsonCursor& at);

  const JsonCursor& at() const { return at_; }
  bool is_object() const { return members_ != nullptr; }
  /// The value of a key, or null. The key is known from now on.
  const JsonNode* find(std::string_view key);
  /// The same for a key that must be there: `missing "key": hint`.
  const JsonNode* require(std::string_view key, std::string_view hint);
  /// Reports a missing key, unless this is no object at all, which was reported before.
  void missing(std::string_view key, std::string_view hint) const;
  /// Reports every key that nobody asked for.
  void finish() const;

 private:
  const JsonCursor& at_;
  const JsonNode::Object* members_;
  std::vector<std::string> known_;
};

/// The list below a cursor, or null with an error.
const JsonNode::List* read_list(const JsonCursor& at);
/// The text below a cursor, or null with an error; `what` says what is expected ("the name of a type").
/// An empty text is an error too.
const std::string* read_text(const JsonCursor& at, std::string_view what);

}  // namespace troupe::worldio
