#pragma once

#include "base/diagnostics.hpp"
#include "worldio/json/json_document.hpp"

#include <string>
#include <string_view>
#include <vector>

/// Reads the values of a parsed JSON text and reports errors in them. A document is a whole JSON text, such
/// as a world file. A JsonNode (worldio/json/json_node.hpp) is one value of a document. A place (Where) is a
/// file and a line. A JSON pointer, such as `/types/r/drive`, names a value by the keys and indices that lead
/// to it.
namespace troupe::worldio {

/// Path of a value in a document, for error messages. It consists of the key or the index of the value, and a
/// pointer to the path of the enclosing value. The text of a path is made only when pointer() or error() is
/// called. The path of the enclosing value, the characters of the key, and the diagnostics must outlive the
/// object.
class DocumentPath {
 public:
  /// Makes the path of the whole document. `where` is its place; errors are added to `diagnostics`.
  DocumentPath(Where where, Diagnostics& diagnostics) : where_(where), diagnostics_(&diagnostics) {}
  DocumentPath(const DocumentPath& parent, std::string_view key, Where where)
      : parent_(&parent), key_(key), where_(where), diagnostics_(parent.diagnostics_) {}
  DocumentPath(const DocumentPath& parent, std::size_t index, Where where)
      : parent_(&parent), index_(index), where_(where), diagnostics_(parent.diagnostics_) {}

  Where where() const { return where_; }
  Diagnostics& diagnostics() const { return *diagnostics_; }
  /// Returns the path as a JSON pointer, such as `/types/r/drive`; empty for the whole document.
  std::string pointer() const;
  /// Reports the error `/types/r/drive: MESSAGE` at the place of this value.
  void error(const std::string& message) const { error_at(where_, message); }
  /// Like error(), but reports the error at the place `where`, such as that of a key in this value. The
  /// message still begins with the path of this value.
  void error_at(Where where, const std::string& message) const;
  /// Reports the warning `/types/r/drive: MESSAGE` at the place of this value.
  void warning(const std::string& message) const;

 private:
  std::string with_path(const std::string& message) const;

  const DocumentPath* parent_ = nullptr;
  std::string_view key_;
  std::size_t index_ = 0;
  Where where_;
  Diagnostics* diagnostics_;
};

/// A JsonNode that is being read, and its path. The node must outlive the cursor, and so must the parent
/// cursor or parent path.
class JsonCursor : public DocumentPath {
 public:
  JsonCursor(const JsonNode& root, Diagnostics& diagnostics)
      : DocumentPath(root.where, diagnostics), node_(&root) {}
  JsonCursor(const JsonCursor& parent, std::string_view key, const JsonNode& node)
      : DocumentPath(parent, key, node.where), parent_(&parent), node_(&node) {}
  JsonCursor(const JsonCursor& parent, std::size_t index, const JsonNode& node)
      : DocumentPath(parent, index, node.where), parent_(&parent), node_(&node) {}
  /// Makes a cursor for a value that was stored apart from its document, such as SettingDocument::drive.
  /// `parent` is the path of the enclosing value. The node of the enclosing value is not known, so parent()
  /// of the new cursor returns null.
  JsonCursor(const DocumentPath& parent, std::string_view key, const JsonNode& node)
      : DocumentPath(parent, key, node.where), node_(&node) {}

  const JsonNode& node() const { return *node_; }
  /// The cursor of the object or list that contains this value. Null if the constructor got no parent cursor.
  const JsonCursor* parent() const { return parent_; }
  /// Reports that the value has the wrong form. For example, expected("a list") reports the error
  /// `expected a list, found the number 3` at this value.
  void expected(std::string_view what) const;

 private:
  const JsonCursor* parent_ = nullptr;
  const JsonNode* node_;
};

/// Reads an object key by key. find() and require() mark the requested keys as known, and finish() then
/// reports all other keys as unknown. The cursor must outlive the JsonObject, which refers to it.
class JsonObject {
 public:
  /// Reports the error `expected WHAT, found ...` if the value at the cursor is not an object. find() then
  /// returns null for every key.
  explicit JsonObject(const JsonCursor& at, std::string_view what = "an object");

  const JsonCursor& at() const { return at_; }
  bool is_object() const { return members_ != nullptr; }
  /// Returns the value of a key, or null if the object lacks it. Marks the key as known.
  const JsonNode* find(std::string_view key);
  /// Like find(), but reports the error `missing "KEY": HINT` if the object lacks the key.
  const JsonNode* require(std::string_view key, std::string_view hint);
  /// Reports the error `missing "KEY": HINT`. Does nothing if the value is not an object, because the
  /// constructor has already reported that.
  void missing(std::string_view key, std::string_view hint) const;
  /// Reports an error for every key of the object that was passed neither to find() nor to require().
  void finish() const;

 private:
  const JsonCursor& at_;
  const JsonNode::Object* members_;
  std::vector<std::string> known_;
};

/// Returns the list at a cursor. If the value is not a list, reports an error and returns null.
const JsonNode::List* read_list(const JsonCursor& at);
/// Whether an error was reported at the value to which a JSON pointer leads, or at a value inside of it. What
/// depends on such a value cannot be checked.
bool has_error_in(const Diagnostics& diagnostics, std::string_view pointer);
/// Reports an error for the list at a cursor if it is empty, where an empty list would mean the same as no
/// list. otherwise: what is used without the list
void refuse_empty(const JsonCursor& at, std::string_view otherwise);
/// Returns the text at a cursor. If the value is not a text or is empty, returns null and reports the error
/// `expected WHAT, found ...`, where WHAT is `what`, such as "the name of a type".
const std::string* read_text(const JsonCursor& at, std::string_view what);
/// As read_text(), for a name, which has at most engine::k_most_name_bytes bytes.
const std::string* read_name(const JsonCursor& at, std::string_view what);
/// Reports an error at the value with this name, and returns false, if the name is too long.
bool check_name(const JsonCursor& at, std::string_view name);
/// Reports an error and returns true if the text at a cursor contains U+0000. Texts become names of files,
/// which end at this character.
bool refuse_nul(const JsonCursor& at, std::string_view text);
/// Reports an error for each text and each key in the value at a cursor that contains U+0000.
void report_nul(const JsonCursor& at);

}  // namespace troupe::worldio
