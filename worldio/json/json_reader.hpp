#pragma once

#include "base/diagnostics.hpp"
#include "worldio/json/json_document.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// How a value of a document is reached, for findings about it. It lives on the stack and points at its
/// parent's, so that the JSON pointer is spelt only when something is reported.
class DocumentPath {
 public:
  /// Of the whole document.
  DocumentPath(Where where, Diagnostics& diagnostics) : where_(where), diagnostics_(&diagnostics) {}
  DocumentPath(const DocumentPath& parent, std::string_view key, Where where)
      : parent_(&parent), key_(key), where_(where), diagnostics_(parent.diagnostics_) {}
  DocumentPath(const DocumentPath& parent, std::size_t index, Where where)
      : parent_(&parent), index_(index), where_(where), diagnostics_(parent.diagnostics_) {}

  Where where() const { return where_; }
  Diagnostics& diagnostics() const { return *diagnostics_; }
  /// `/robots/3/drive`; empty for the document itself.
  std::string pointer() const;
  /// Reports at this value: `/robots/3/drive: message`.
  void error(const std::string& message) const { error_at(where_, message); }
  void error_at(Where where, const std::string& message) const;

 private:
  const DocumentPath* parent_ = nullptr;
  std::string_view key_;
  std::size_t index_ = 0;
  Where where_;
  Diagnostics* diagnostics_;
};

/// The same of a value that is being read.
class JsonCursor : public DocumentPath {
 public:
  JsonCursor(const JsonNode& root, Diagnostics& diagnostics)
      : DocumentPath(root.where, diagnostics), node_(&root) {}
  JsonCursor(const JsonCursor& parent, std::string_view key, const JsonNode& node)
      : DocumentPath(parent, key, node.where), parent_(&parent), node_(&node) {}
  JsonCursor(const JsonCursor& parent, std::size_t index, const JsonNode& node)
      : DocumentPath(parent, index, node.where), parent_(&parent), node_(&node) {}
  /// Of a node that a document kept as it was.
  JsonCursor(const DocumentPath& parent, std::string_view key, const JsonNode& node)
      : DocumentPath(parent, key, node.where), node_(&node) {}

  const JsonNode& node() const { return *node_; }
  /// Of the object or list that holds this value; null where it is not being read.
  const JsonCursor* parent() const { return parent_; }
  /// Reports `expected WHAT, found ...`.
  void expected(std::string_view what) const;

 private:
  const JsonCursor* parent_ = nullptr;
  const JsonNode* node_;
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
  /// Reports every key that was not read.
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
