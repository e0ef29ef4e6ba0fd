#pragma once

#include "base/diagnostics.hpp"
#include "worldio/json/json_document.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// Path to a value of a document, for error messages. A path is an object on the stack that points at the
/// path of the enclosing value, so that the JSON pointer is formatted only if there is an error. The
/// enclosing path, the text of the key, and the diagnostics must outlive the path.
class DocumentPath {
 public:
  /// The path of the whole document.
  DocumentPath(Where where, Diagnostics& diagnostics) : where_(where), diagnostics_(&diagnostics) {}
  DocumentPath(const DocumentPath& parent, std::string_view key, Where where)
      : parent_(&parent), key_(key), where_(where), diagnostics_(parent.diagnostics_) {}
  DocumentPath(const DocumentPath& parent, std::size_t index, Where where)
      : parent_(&parent), index_(index), where_(where), diagnostics_(parent.diagnostics_) {}

  Where where() const { return where_; }
  Diagnostics& diagnostics() const { return *diagnostics_; }
  /// Returns the path as a JSON pointer, such as `/types/r/drive`; empty for the document itself.
  std::string pointer() const;
  /// Reports an error at this value: `/types/r/drive: message`.
  void error(const std::string& message) const { error_at(where_, message); }
  /// Like error(), but reports the error at another place in a file, such as that of a key.
  void error_at(Where where, const std::string& message) const;

 private:
  const DocumentPath* parent_ = nullptr;
  std::string_view key_;
  std::size_t index_ = 0;
  Where where_;
  Diagnostics* diagnostics_;
};

/// A value that is being read, and the path to it. The value must outlive the cursor, as must the objects
/// that DocumentPath names.
class JsonCursor : public DocumentPath {
 public:
  JsonCursor(const JsonNode& root, Diagnostics& diagnostics)
      : DocumentPath(root.where, diagnostics), node_(&root) {}
  JsonCursor(const JsonCursor& parent, std::string_view key, const JsonNode& node)
      : DocumentPath(parent, key, node.where), parent_(&parent), node_(&node) {}
  JsonCursor(const JsonCursor& parent, std::size_t index, const JsonNode& node)
      : DocumentPath(parent, index, node.where), parent_(&parent), node_(&node) {}
  /// For a node that a WorldDocument (the struct with the content of a JSON world) stores as unread JSON.
  /// `parent` is the path of the enclosing value, whose node is not known: parent() of this cursor returns
  /// null.
  JsonCursor(const DocumentPath& parent, std::string_view key, const JsonNode& node)
      : DocumentPath(parent, key, node.where), node_(&node) {}

  const JsonNode& node() const { return *node_; }
  /// The object or list that contains this value; null for the value at which reading began.
  const JsonCursor* parent() const { return parent_; }
  /// Reports the error `expected WHAT, found ...` at this value, where WHAT is `what`. The message ends with
  /// a description of the value (JsonNode::describe()).
  void expected(std::string_view what) const;

 private:
  const JsonCursor* parent_ = nullptr;
  const JsonNode* node_;
};

/// Reads an object key by key. It remembers the keys that the caller asks for, so that finish() can report
/// every other key as unknown. The cursor must outlive the JsonObject, which refers to it.
class JsonObject {
 public:
  /// Reports an error if the value at the cursor is not an object. Every find() then returns null.
  explicit JsonObject(const JsonCursor& at);

  const JsonCursor& at() const { return at_; }
  bool is_object() const { return members_ != nullptr; }
  /// Returns the value of a key, or null if the object lacks it. Marks the key as known.
  const JsonNode* find(std::string_view key);
  /// Like find(), but reports the error `missing "key": hint` if the object lacks the key.
  const JsonNode* require(std::string_view key, std::string_view hint);
  /// Reports the error `missing "key": hint`. Does nothing if the value is not an object, because the
  /// constructor has already reported that.
  void missing(std::string_view key, std::string_view hint) const;
  /// Reports an error for every key of the object that the caller did not ask for.
  void finish() const;

 private:
  const JsonCursor& at_;
  const JsonNode::Object* members_;
  std::vector<std::string> known_;
};

/// Returns the list at a cursor. If the value is not a list, reports an error and returns null.
const JsonNode::List* read_list(const JsonCursor& at);
/// Returns the text at a cursor. If the value is not a text or is empty, returns null and reports the error
/// `expected WHAT, found ...`, where WHAT is `what`, such as "the name of a type".
const std::string* read_text(const JsonCursor& at, std::string_view what);

}  // namespace troupe::worldio
