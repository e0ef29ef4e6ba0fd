#include "worldio/json/json_document.hpp"

#include "base/number_text.hpp"
#include "base/result.hpp"
#include "worldio/characters.hpp"
#include "worldio/json/json_syntax.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <unordered_map>
#include <utility>

namespace troupe::worldio {
namespace {

constexpr std::size_t k_max_depth = 64;  // limited, because the reader and the destructors are recursive

/// How far the parser has read the text: the present line, from 1, and the last character that it has read.
/// A line ends with LF, CR LF or CR, as in line_at().
struct Progress {
  std::uint32_t line = 1;
  char last = 0;
};

/// An iterator over the text that updates a Progress while the parser reads, because nlohmann's parser does
/// not report the lines of values.
class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(const char* at, Progress* progress) : at_(at), progress_(progress) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    progress_->line += *at_ == '\r' || (*at_ == '\n' && progress_->last != '\r');
    progress_->last = *at_;
    ++at_;
    return *this;
  }
  friend bool operator==(const CountingIterator& a, const CountingIterator& b) { return a.at_ == b.at_; }

 private:
  const char* at_;
  Progress* progress_;
};

/// Returns the column, from 1, of the character at this position of a text in UTF-8.
std::size_t column_at(std::string_view text, std::size_t position) {
  const std::string_view before = text.substr(0, position);
  std::string_view line = before.substr(before.find_last_of("\r\n") + 1);  // npos + 1 is 0
  if (line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);             // byte-order mark
  const auto is_first = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; };
  return 1 + static_cast<std::size_t>(std::ranges::count_if(line, is_first));
}

void report_repeated(const JsonNode::Object& members, bool fixed_place, Diagnostics& diagnostics) {
  std::unordered_map<std::string_view, Where> seen;
  for (const JsonMember& member : members) {
    const auto [first, fresh] = seen.emplace(member.key, member.where);
    if (fresh) continue;
    diagnostics.error(member.where, fixed_place ? fmt::format("repeated key \"{}\"", member.key)
                                                : fmt::format("repeated key \"{}\": first given on line {}",
                                                              member.key, first->second.line));
  }
}

/// Builds the tree from the events of nlohmann's SAX interface.
class TreeBuilder {
 public:
  TreeBuilder(std::string_view text, const Progress& progress, Where start, bool fixed_place,
              Diagnostics& diagnostics)
      : text_(text),
        progress_(progress),
        start_(start),
        fixed_place_(fixed_place),
        diagnostics_(diagnostics) {}

  bool null() { return add(std::monostate{}); }
  bool boolean(bool x) { return add(x); }
  bool number_integer(std::int64_t x) { return add(x, true); }
  bool number_unsigned(std::uint64_t x) {
    constexpr auto k_max = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
    return x <= k_max ? add(static_cast<std::int64_t>(x), true) : add(x, true);
  }
  bool number_float(double x, const std::string&) { return add(x, true); }
  bool string(std::string& x) { return add(std::move(x)); }
  bool binary(nlohmann::json::binary_t&) { return false; }  // does not occur in JSON text

  bool start_array(std::size_t) { return add(JsonNode::List{}) && open(); }
  bool end_array() { return close(); }
  bool start_object(std::size_t) { return add(JsonNode::Object{}) && open(); }
  bool key(std::string& x) {
    auto& members = std::get<JsonNode::Object>(open_.back()->value);
    members.push_back({std::move(x), here(false), {}});
    return true;
  }
  bool end_object() {
    report_repeated(std::get<JsonNode::Object>(open_.back()->value), fixed_place_, diagnostics_);
    return close();
  }

  bool parse_error(std::size_t position, const std::string&, const nlohmann::json::exception& error) {
    const std::size_t last = position > 0 ? position - 1 : 0;  // the last byte that the parser has read
    constexpr int k_out_of_range = 406;  // nlohmann's id for a number that is too large for a double
    if (error.id == k_out_of_range) {
      const std::string_view read = text_.substr(0, last + 1);
      const std::string_view number = read.substr(read.find_last_not_of("0123456789.eE+-") + 1);
      report(last, fmt::format("{}{}{} is too large: numbers are from -1.7e308 to 1.7e308", next_pointer(),
                               open_.empty() ? "" : ": ", number));
      return false;
    }
    const JsonSyntaxError found = json_syntax_error(text_, last);
    const std::uint32_t line = line_at(text_, found.at);
    const std::string line_text = fixed_place_ && line > 1 ? fmt::format("line {}, ", line) : "";
    report(found.at, fmt::format("{}column {}: {}", line_text, column_at(text_, found.at), found.what));
    return false;
  }

  JsonNode take() { return std::move(root_); }

 private:
  void report(std::size_t at, const std::string& what) {
    diagnostics_.error(fixed_place_ ? start_ : Where{start_.file, line_at(text_, at)}, what);
  }

  /// Returns the place of the value or key that the parser has just read. `read_ahead` must be true for a
  /// number: the parser finds the end of a number only by reading the next character, which may be the end of
  /// the line.
  Where here(bool read_ahead) const {
    if (fixed_place_) return start_;
    const bool passed = read_ahead && (progress_.last == '\n' || progress_.last == '\r');
    return {start_.file, progress_.line - (passed ? 1 : 0)};
  }

  /// Returns the JSON pointer to the value that the parser is reading.
  std::string next_pointer() const {
    std::string pointer;
    for (const JsonNode* node : open_) {
      pointer += '/';
      if (const auto* list = node->list())
        pointer += std::to_string(node == open_.back() ? list->size() : list->size() - 1);
      else
        pointer += escape_pointer_token(node->object()->back().key);
    }
    return pointer;
  }

  template <class T>
  bool add(T&& x, bool read_ahead = false) {
    JsonNode* node = &root_;
    if (!open_.empty()) {
      if (auto* list = std::get_if<JsonNode::List>(&open_.back()->value))
        node = &list->emplace_back();
      else
        node = &std::get<JsonNode::Object>(open_.back()->value).back().node;
    }
    node->value = std::forward<T>(x);
    node->where = here(read_ahead);
    last_ = node;
    return true;
  }

  bool open() {
    if (open_.size() == k_max_depth) {
      diagnostics_.error(
          last_->where,
          fmt::format("lists and objects are nested too deeply: at most {} levels are allowed", k_max_depth));
      return false;
    }
    // This pointer stays valid, because its list gets no other entry until this value is closed.
    open_.push_back(last_);
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  std::string_view text_;
  const Progress& progress_;
  Where start_;
  bool fixed_place_;
  Diagnostics& diagnostics_;
  JsonNode root_;
  JsonNode* last_ = nullptr;
  std::vector<JsonNode*> open_;
};

/// Returns the list index that a token of a JSON pointer means. The token `-`, which appends, means `size`,
/// the length of the list. Empty if the token is neither a number nor `-`.
std::optional<std::size_t> list_index(const std::string& token, std::size_t size) {
  if (token == "-") return size;
  return number_of<std::size_t>(token);
}

/// Returns a hint for a message about a pointer that contains the name of a list's entry in place of its
/// index, with a leading "; ". Empty if no entry has this name. `path` is the pointer to the list.
std::string index_hint(const JsonNode::List& list, const std::string& name, const std::string& path) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    const JsonNode* entry_name = list[i].find("name");
    if (entry_name && entry_name->text() && *entry_name->text() == name)
      return fmt::format("; the entry called \"{}\" is {}/{}", name, path, i);
  }
  return {};
}

/// Returns a hint for a message about a key that a type does not have itself, but inherits by `extends`, with
/// a leading space. Empty if no type from which it inherits has the key. `types` contains all types of the
/// world.
std::string base_hint(const JsonNode& types, const JsonNode& type, const std::string& key) {
  const JsonNode* heir = &type;
  for (std::size_t left = types.object() ? types.object()->size() : 0; left > 0; --left) {
    const JsonNode* base = heir->find("extends");
    if (!base || !base->text()) break;
    heir = types.find(*base->text());
    if (!heir) break;
    if (heir->find(key))
      return fmt::format(" of its own: change the inherited key in /types/{}, or add a \"{}\" to this type",
                         escape_pointer_token(*base->text()), key);
  }
  return {};
}

/// Converts the value of `--set` to a JSON value. A value that is not JSON is a text, unless it begins like
/// an object or a list: this is an error, and the result is empty.
std::optional<JsonNode> node_to_set(const std::string& value, Where where, Diagnostics& diagnostics) {
  const std::size_t first = value.find_first_not_of(" \t\n\r");
  const bool is_structure = first != value.npos && (value[first] == '{' || value[first] == '[');
  Diagnostics unread;  // ignored, because another value that is not JSON is taken as a text
  std::optional<JsonNode> node = parse_json(value, where, true, is_structure ? diagnostics : unread);
  if (!node && !is_structure) node = JsonNode{.value = value, .where = where};
  return node;
}

/// Returns the entry or member of `node` that `token`, a token of a JSON pointer, names. If it is to be set
/// itself, it may be a new member or the entry after the last, which is then added. Returns an error if there
/// is none.
///
/// around: the node that contains `node`, for errors
/// pointer: JSON pointer to `node`, for errors
/// is_last: whether the value is to be set itself, and not a value inside it
/// where: the place of a new member
Result<JsonNode*> child_to_set(JsonNode& node, const JsonNode& around, const std::string& pointer,
                               const std::string& token, bool is_last, Where where) {
  const std::string name = pointer.empty() ? "the world" : pointer;
  const std::string path = fmt::format("{}/{}", pointer, escape_pointer_token(token));
  if (auto* list = std::get_if<JsonNode::List>(&node.value)) {
    const auto index = list_index(token, list->size());
    if (!index)
      return Error{fmt::format("{} is a list: \"{}\" is neither an index nor \"-\", which appends an entry{}",
                               name, token, index_hint(*list, token, name))};
    if (*index > list->size() || (*index == list->size() && !is_last))
      return Error{fmt::format("{} is a list of length {}, whose entries are counted from 0: there is no {}",
                               name, list->size(), path)};
    return *index == list->size() ? &list->emplace_back() : &(*list)[*index];
  }
  auto* members = std::get_if<JsonNode::Object>(&node.value);
  if (!members)
    return Error{
        fmt::format("{} is {}, not an object or a list: there is no {}", name, node.describe(), path)};
  if (JsonNode* member = node.find(token)) return member;
  if (is_last) return &members->emplace_back(JsonMember{token, where, {}}).node;
  std::vector<std::string_view> known;
  for (const JsonMember& m : *members) known.push_back(m.key);
  std::string hint = base_hint(around, node, token);
  if (hint.empty()) hint = did_you_mean(token, known);
  if (hint.empty()) hint = fmt::format(": to add it, set {} as a whole", path);
  return Error{fmt::format("{} has no key \"{}\"{}", name, token, hint)};
}

}  // namespace

const JsonNode* JsonNode::find(std::string_view key) const {
  if (const Object* members = object())
    for (const JsonMember& member : *members)
      if (member.key == key) return &member.node;
  return nullptr;
}

std::string JsonNode::describe() const {
  struct {
    std::string operator()(std::monostate) const { return "null"; }
    std::string operator()(bool x) const { return x ? "true" : "false"; }
    std::string operator()(std::int64_t x) const { return fmt::format("the number {}", x); }
    std::string operator()(std::uint64_t x) const { return fmt::format("the number {}", x); }
    std::string operator()(double x) const {
      const std::string text = fmt::format("{}", x);  // "5" for 5.0, which would read like a whole number
      return fmt::format("the number {}{}", text, text.find_first_of(".e") == text.npos ? ".0" : "");
    }
    std::string operator()(const std::string& x) const { return fmt::format("the text \"{}\"", x); }
    std::string operator()(const List& x) const { return fmt::format("a list of length {}", x.size()); }
    std::string operator()(const Object&) const { return "an object"; }
  } words;
  return std::visit(words, value);
}

std::optional<JsonNode> parse_json(std::string_view text, Where start, bool fixed_place,
                                   Diagnostics& diagnostics) {
  if (is_utf16(text)) {
    diagnostics.error(start, k_is_utf16);
    return std::nullopt;
  }
  // nlohmann's parser takes a NUL byte as the end of the text, and would ignore everything after it.
  if (const std::size_t nul = text.find('\0'); nul != text.npos) {
    diagnostics.error(fixed_place ? start : Where{start.file, line_at(text, nul)},
                      "the text contains a NUL byte (U+0000), which is not allowed in JSON");
    return std::nullopt;
  }
  const std::size_t before = diagnostics.findings().size();
  Progress progress;
  TreeBuilder builder(text, progress, start, fixed_place, diagnostics);
  const bool whole =
      nlohmann::json::sax_parse(CountingIterator(text.data(), &progress),
                                CountingIterator(text.data() + text.size(), &progress), &builder);
  if (!whole || diagnostics.findings().size() > before) return std::nullopt;
  return builder.take();
}

void set_json_value(JsonNode& document, const std::string& pointer, const std::string& value,
                    Diagnostics& diagnostics) {
  const Where where{diagnostics.files()->add("--set " + pointer), 0};
  const auto tokens = pointer_tokens(pointer);
  if (!tokens) {
    diagnostics.error(where,
                      "this is not a JSON pointer: it must begin with /, as in /populations/0/count, and "
                      "contain ~ only as ~0 or ~1");
    return;
  }
  std::optional<JsonNode> node = node_to_set(value, where, diagnostics);
  if (!node) return;
  JsonNode* at = &document;
  const JsonNode* around = at;
  std::string path;
  for (std::size_t i = 0; i < tokens->size(); ++i) {
    const std::string& token = (*tokens)[i];
    const Result<JsonNode*> child = child_to_set(*at, *around, path, token, i + 1 == tokens->size(), where);
    if (!child) return diagnostics.error(where, child.error().text);
    around = std::exchange(at, *child);
    path += '/';
    path += escape_pointer_token(token);
  }
  *at = std::move(*node);
}

void report_repeated_keys(const JsonNode& node, Diagnostics& diagnostics) {
  if (const auto* list = node.list())
    for (const JsonNode& item : *list) report_repeated_keys(item, diagnostics);
  const auto* object = node.object();
  if (!object) return;
  for (const JsonMember& member : *object) report_repeated_keys(member.node, diagnostics);
  report_repeated(*object, node.where.line == 0, diagnostics);
}

void place_nodes(JsonNode& node, const Where& around) {
  if (node.where.file == Where::k_no_file) node.where = around;
  if (auto* list = std::get_if<JsonNode::List>(&node.value))
    for (JsonNode& item : *list) place_nodes(item, node.where);
  if (auto* object = std::get_if<JsonNode::Object>(&node.value))
    for (JsonMember& member : *object) {
      place_nodes(member.node, node.where);
      member.where = member.node.where;
    }
}

std::optional<std::vector<std::string>> pointer_tokens(const std::string& pointer) {
  if (pointer.empty() || pointer[0] != '/') return std::nullopt;
  std::vector<std::string> tokens;
  for (std::size_t i = 0; i < pointer.size(); ++i) {
    if (pointer[i] == '/') {
      tokens.emplace_back();
    } else if (pointer[i] == '~') {
      if (i + 1 == pointer.size() || (pointer[i + 1] != '0' && pointer[i + 1] != '1')) return std::nullopt;
      tokens.back() += pointer[++i] == '0' ? '~' : '/';
    } else {
      tokens.back() += pointer[i];
    }
  }
  return tokens;
}

std::string escape_pointer_token(std::string_view token) {
  std::string escaped;
  for (const char c : token) {
    if (c == '~')
      escaped += "~0";
    else if (c == '/')
      escaped += "~1";
    else
      escaped += c;
  }
  return escaped;
}

}  // namespace troupe::worldio
