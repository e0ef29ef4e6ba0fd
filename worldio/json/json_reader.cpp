#include "worldio/json/json_reader.hpp"

#include "base/split.hpp"
#include "engine/fields/fields.hpp"
#include "engine/spec/names.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace troupe::worldio {
namespace {

/// Returns a suggestion for an unknown key that differs from known keys only in its unit, such as
/// `quit_time_min`. Empty if there are no such keys. did_you_mean() would suggest `quit_time_ms`.
std::string unit_hint(std::string_view key, const std::vector<std::string>& known) {
  std::vector<std::string> near;
  const auto add_if_known = [&](std::string candidate) {
    if (std::ranges::find(known, candidate) != known.end()) near.push_back(std::move(candidate));
  };
  const std::string_view name = key.substr(0, key.rfind('_'));
  for (const engine::Unit unit : engine::all_units())
    for (const engine::UnitSuffix& in : engine::unit_suffixes(unit)) {
      add_if_known(std::string(name) + std::string(in.suffix));
      if (key.ends_with(in.suffix)) add_if_known(std::string(key.substr(0, key.size() - in.suffix.size())));
    }
  return near.empty() ? std::string() : fmt::format(" (did you mean \"{}\"?)", joined(near, "\" or \""));
}

}  // namespace

std::string DocumentPath::pointer() const {
  if (!parent_) return {};
  return parent_->pointer() + "/" + (key_.data() ? escape_pointer_token(key_) : std::to_string(index_));
}

std::string DocumentPath::with_path(const std::string& message) const {
  const std::string path = pointer();
  return path.empty() ? message : path + ": " + message;
}

void DocumentPath::error_at(Where where, const std::string& message) const {
  diagnostics_->error(where, with_path(message));
}

void DocumentPath::warning(const std::string& message) const {
  diagnostics_->warning(where_, with_path(message));
}

void JsonCursor::expected(std::string_view what) const {
  error(fmt::format("expected {}, found {}", what, node_->describe()));
}

JsonObject::JsonObject(const JsonCursor& at, std::string_view what) : at_(at), members_(at.node().object()) {
  if (!members_) at.expected(what);
}

const JsonNode* JsonObject::find(std::string_view key) {
  if (!members_) return nullptr;
  if (std::ranges::find(known_, key) == known_.end()) known_.emplace_back(key);
  return at_.node().find(key);
}

const JsonNode* JsonObject::require(std::string_view key, std::string_view hint) {
  const JsonNode* node = find(key);
  if (!node) missing(key, hint);
  return node;
}

void JsonObject::missing(std::string_view key, std::string_view hint) const {
  if (members_) at_.error(fmt::format("missing \"{}\": {}", key, hint));
}

void JsonObject::finish() const {
  if (!members_) return;
  for (const JsonMember& member : *members_)
    if (std::ranges::find(known_, member.key) == known_.end())
      at_.error_at(member.where, unknown_name("key", member.key,
                                              std::vector<std::string_view>(known_.begin(), known_.end()),
                                              unit_hint(member.key, known_)));
}

const JsonNode::List* read_list(const JsonCursor& at) {
  const JsonNode::List* list = at.node().list();
  if (!list) at.expected("a list");
  return list;
}

bool has_error_in(const Diagnostics& diagnostics, std::string_view pointer) {
  return std::ranges::any_of(diagnostics.findings(), [&](const Finding& finding) {
    const std::string_view text = finding.message;
    return finding.severity == Severity::error && text.starts_with(pointer) &&
           text.find_first_of("/:", pointer.size()) == pointer.size();
  });
}

void refuse_empty(const JsonCursor& at, std::string_view otherwise) {
  if (at.node().list() && at.node().list()->empty())
    at.error(fmt::format("the list is empty: give at least one entry, or remove the key, for {}", otherwise));
}

bool check_name(const JsonCursor& at, std::string_view name) {
  if (name.size() <= engine::k_most_name_bytes) return true;
  at.error(fmt::format("the name has {} bytes, but a name has at most {}", name.size(),
                       engine::k_most_name_bytes));
  return false;
}

const std::string* read_name(const JsonCursor& at, std::string_view what) {
  const std::string* name = read_text(at, what);
  return name && check_name(at, *name) ? name : nullptr;
}

const std::string* read_text(const JsonCursor& at, std::string_view what) {
  const std::string* text = at.node().text();
  if (text && !text->empty()) return text;
  at.expected(what);
  return nullptr;
}

bool refuse_nul(const JsonCursor& at, std::string_view text) {
  if (text.find('\0') == text.npos) return false;
  at.error("the text contains the character U+0000 (\\u0000): remove it");
  return true;
}

void report_nul(const JsonCursor& at) {
  const JsonNode& node = at.node();
  if (const std::string* text = node.text()) refuse_nul(at, *text);
  if (const JsonNode::List* list = node.list())
    for (std::size_t i = 0; i < list->size(); ++i) report_nul({at, i, (*list)[i]});
  if (const JsonNode::Object* members = node.object())
    for (const JsonMember& member : *members) {
      if (member.key.find('\0') != member.key.npos)
        at.diagnostics().error(member.where, "a key contains the character U+0000 (\\u0000): remove it");
      else
        report_nul({at, member.key, member.node});
    }
}

}  // namespace troupe::worldio
