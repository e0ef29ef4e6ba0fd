#include "worldio/stage/stage_parser.hpp"

#include "base/number_text.hpp"
#include "engine/spec/names.hpp"
#include "worldio/characters.hpp"
#include "worldio/files.hpp"
#include "worldio/stage/stage_files.hpp"
#include "worldio/stage/stage_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <system_error>

namespace troupe::worldio {
namespace {

namespace fs = std::filesystem;
using TokenKind = StageToken::Kind;

constexpr std::size_t k_most_errors = 50;
constexpr std::size_t k_most_inclusions = 1000;
constexpr std::size_t k_most_included_bytes = 256 << 20;  // a file counts each time it is included

/// Thrown when it is no longer useful to continue parsing. parse_stage() catches it.
struct GiveUp {};

class SyntaxErrors {
 public:
  explicit SyntaxErrors(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  void add(Where where, std::string message) {
    diagnostics_.error(where, std::move(message));
    if (++count_ == k_most_errors) {
      diagnostics_.error(
          where,
          fmt::format("stopped after {} syntax errors; the rest of the file is not read", k_most_errors));
      throw GiveUp{};
    }
  }

 private:
  Diagnostics& diagnostics_;
  std::size_t count_ = 0;
};

constexpr std::string_view k_free = "strings and comments";  // where any character is allowed

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_word_part(char c) {
  return is_letter(c) || is_digit(c) || c == '.' || c == '-' || c == '_' || c == '[' || c == ']';
}
bool is_number_part(char c) { return is_digit(c) || c == '+' || c == '-' || c == '.'; }
bool is_blank(char c) { return c == ' ' || c == '\t'; }
bool is_line_end(char c) { return c == '\n' || c == '\r'; }

/// Returns the length of the text before the first unmatched bracket in `word`. The word ends there, because
/// the bracket begins or ends a tuple.
std::size_t matched_length(std::string_view word) {
  std::size_t open = std::string_view::npos;
  for (std::size_t i = 0; i < word.size(); ++i) {
    if (word[i] == '[') {
      if (open != std::string_view::npos) return open;
      open = i;
    } else if (word[i] == ']') {
      if (open == std::string_view::npos) return i;
      open = std::string_view::npos;
    }
  }
  return open == std::string_view::npos ? word.size() : open;
}

class Lexer {
 public:
  Lexer(StageDocument& document, std::span<const fs::path> search_path, Diagnostics& diagnostics,
        SyntaxErrors& errors)
      : document_(document), search_path_(search_path), diagnostics_(diagnostics), errors_(errors) {}

  void read(const fs::path& file, std::string text) {
    const std::uint32_t name = diagnostics_.files()->add(file.string());
    if (is_utf16(text)) {
      errors_.add({name, 0}, k_is_utf16);
      throw GiveUp{};
    }
    text = lines_in_utf8(std::move(text));  // names become texts of JSON and HDF5 files, which are UTF-8
    if (text.size() > std::numeric_limits<std::uint32_t>::max()) {
      errors_.add({name, 0}, fmt::format("the file has {} bytes; at most 2^32 - 1 are allowed", text.size()));
      throw GiveUp{};
    }
    document_.sources.push_back({std::move(text), name});
    open_files_.push_back(identity(file));
    Source source{document_.sources.back().text, name,
                  static_cast<std::uint16_t>(document_.sources.size() - 1)};
    if (source.text.starts_with("\xef\xbb\xbf")) source.at = 3;  // the byte-order mark of some editors
    while (source.at < source.text.size()) next(source);
    open_files_.pop_back();
  }

 private:
  struct Source {
    std::string_view text;
    std::uint32_t file;
    std::uint16_t number;  // index into StageDocument::sources, at most k_most_inclusions
    std::size_t at = 0;
    std::uint32_t line = 1;

    Where where() const { return {file, line}; }
    char peek() const { return at < text.size() ? text[at] : '\0'; }
    template <class Part>
    std::string_view take_while(Part part) {
      const std::size_t from = at;
      while (at < text.size() && part(text[at])) ++at;
      return text.substr(from, at - from);
    }
    /// Moves past one line end: LF, CR, CRLF or LFCR.
    void take_line_end() {
      const char c = text[at++];
      if (at < text.size() && is_line_end(text[at]) && text[at] != c) ++at;
      ++line;
    }
  };

  static fs::path identity(const fs::path& file) {
    std::error_code error;
    fs::path whole = fs::weakly_canonical(file, error);
    return error ? file : whole;
  }

  void add(const Source& source, TokenKind kind, std::string_view text) {
    document_.tokens.push_back({source.number, kind, source.line,
                                static_cast<std::uint32_t>(text.data() - source.text.data()),
                                static_cast<std::uint32_t>(text.size())});
  }

  void next(Source& source) {
    const char c = source.peek();
    if (is_blank(c)) {
      ++source.at;
    } else if (is_line_end(c)) {
      source.take_line_end();
    } else if (c == '#') {
      source.take_while([](char x) { return !is_line_end(x); });
    } else if (is_letter(c)) {
      word(source);
    } else if (is_number_part(c)) {
      number(source);
    } else if (c == '"') {
      string(source);
    } else if (c == '(' || c == ')' || c == '[' || c == ']') {
      constexpr std::string_view brackets = "()[]";
      constexpr TokenKind kinds[] = {TokenKind::open, TokenKind::close, TokenKind::tuple_open,
                                     TokenKind::tuple_close};
      add(source, kinds[brackets.find(c)], source.text.substr(source.at, 1));
      ++source.at;
    } else {
      const StrayCharacter stray = stray_at(source);
      source.at += stray.bytes;
      errors_.add(source.where(), stray.error);
    }
  }

  /// Describes the character at the place of the source, which can begin no token.
  static StrayCharacter stray_at(const Source& source) {
    const char c = source.peek();
    const bool is_ascii = static_cast<unsigned char>(c) < 128;
    return is_ascii ? StrayCharacter{1, stray(c)} : stray_character(source.text, source.at, k_free);
  }

  /// Returns the error text for an ASCII character that can begin no token.
  static std::string stray(char c) {
    if (c == ',') return "unexpected ','; the values of a tuple are separated by blanks: [1 2 3]";
    if (c == '=') return "unexpected '='; a property is written: name value";
    if (c == ';') return "unexpected ';'; a line end or a blank separates properties";
    if (c == '{' || c == '}')
      return fmt::format("unexpected '{}'; the properties of a model are written in ( )", c);
    if (c == '\'') return "unexpected \"'\"; strings are written in double quotes";
    if (c > ' ' && c < 127)
      return fmt::format("unexpected '{}': this character may be only in {}", c, k_free);
    if (c == '\0') return "unexpected byte 0x00: remove this byte";
    return fmt::format("unexpected byte 0x{:02x}: this byte may be only in {}", static_cast<unsigned char>(c),
                       k_free);
  }

  void word(Source& source) {
    std::string_view text = source.take_while(is_word_part);
    if (const std::size_t length = matched_length(text); length < text.size()) {
      if (text[length] == '[')
        errors_.add(source.where(), fmt::format("\"{}\": a blank is needed before the [", text));
      source.at -= text.size() - length;
      text = text.substr(0, length);
    }
    if (text == "include")
      include(source);
    else
      add(source, TokenKind::word, text);
  }

  void number(Source& source) {
    const std::string_view text = source.take_while(is_number_part);
    if (is_letter(source.peek()) || source.peek() == '_') {
      const std::string_view rest = source.take_while(is_word_part);
      errors_.add(
          source.where(),
          fmt::format("\"{}{}\" is not a number; numbers are written without an exponent and without a unit, "
                      "as in 0.02",
                      text, rest));
    }
    add(source, TokenKind::number, text);
  }

  struct Quoted {
    std::string_view text;
    bool is_right = true;
  };

  /// Reads a text in double quotes. Reports an error if it is not right.
  Quoted quoted(Source& source) {
    ++source.at;
    Quoted read{source.take_while([](char x) { return x != '"' && !is_line_end(x); })};
    const auto refuse = [&](const char* message) {
      errors_.add(source.where(), message);
      read.is_right = false;
    };
    if (source.peek() == '"')
      ++source.at;
    else
      refuse("a string must end with \" on the line on which it begins");
    // Texts become names of files, which end at this byte.
    if (read.text.find('\0') != read.text.npos) refuse("a string contains the byte 0x00: remove this byte");
    return read;
  }

  void string(Source& source) { add(source, TokenKind::string, quoted(source).text); }

  void include(Source& source) {
    const Where where = source.where();
    source.take_while(is_blank);
    if (source.peek() != '"') {
      errors_.add(where, "include needs a file name in double quotes: include \"map.inc\"");
      return;
    }
    const Quoted name = quoted(source);
    if (!name.is_right) return;
    // Stage silently drops the rest of the line after an include; Troupe reports the rest in a warning.
    std::string_view rest = source.take_while([](char x) { return !is_line_end(x); });
    rest = rest.substr(std::min(rest.size(), rest.find_first_not_of(" \t")));
    if (!rest.empty() && rest[0] != '#')
      diagnostics_.warning(
          where, fmt::format("the rest of the line after an include is ignored, as in Stage: {}", rest));
    splice(where, name.text);
  }

  void splice(Where where, std::string_view name) {
    fs::path path(name);
    if (!path.is_absolute() && !name.starts_with('~')) path = document_.base_directory / path;
    const std::optional<fs::path> found = find_stage_file(path, search_path_);
    std::optional<std::string> text = found ? read_file(*found) : std::nullopt;
    if (!text) {
      report_missing(where, found.value_or(path.lexically_normal()));
      return;
    }
    if (*found != path) document_.base_directory = found->parent_path();
    const fs::path self = identity(*found);
    if (const auto it = std::ranges::find(open_files_, self); it != open_files_.end()) {
      std::string cycle;
      for (auto open = it; open != open_files_.end(); ++open) cycle += open->filename().string() + " -> ";
      errors_.add(where, fmt::format("include cycle: {}{}", cycle, self.filename().string()));
      return;
    }
    if (++inclusions_ > k_most_inclusions) {
      errors_.add(where, fmt::format("too many included files: at most {} are allowed, and a file counts "
                                     "each time it is included: merge some of the files",
                                     k_most_inclusions));
      throw GiveUp{};
    }
    included_bytes_ += text->size();
    if (included_bytes_ > k_most_included_bytes) {
      errors_.add(where,
                  fmt::format("the included files are too large: at most {} MiB in total are allowed, and a "
                              "file counts each time it is included",
                              k_most_included_bytes >> 20));
      throw GiveUp{};
    }
    read(tidied(*found), std::move(*text));
  }

  /// Reports an included file that cannot be read.
  void report_missing(Where where, const fs::path& file) {
    const std::string name = file.filename().string();
    if (std::ranges::find(document_.missing_includes, name) == document_.missing_includes.end())
      document_.missing_includes.push_back(name);
    const Result<> readable = check_readable(file, k_most_input_bytes);
    std::string message = fmt::format("cannot read the included file {}: {}", file.string(),
                                      readable ? "it cannot be read" : readable.error().text);
    std::error_code ignored;
    if (fs::exists(fs::symlink_status(file, ignored))) {  // it is there, but unreadable
      errors_.add(where, std::move(message));
      return;
    }
    if (!search_path_.empty()) message += ", and none of that name in the folders of the search path";
    if (comes_with_stage(name))
      message +=
          "; it comes with Stage: name the folder that has it, such as worlds in the sources of Stage, in "
          "the environment variable STAGEPATH (in programs: search_path)";
    errors_.add(where, std::move(message));
  }

  StageDocument& document_;
  std::span<const fs::path> search_path_;
  Diagnostics& diagnostics_;
  SyntaxErrors& errors_;
  std::vector<fs::path> open_files_;
  std::size_t inclusions_ = 0;
  std::size_t included_bytes_ = 0;
};

class Parser {
 public:
  Parser(StageDocument& document, SyntaxErrors& errors) : document_(document), errors_(errors) {}

  void read() {
    while (peek().kind != TokenKind::end) {
      const StageToken token = peek();
      if (token.kind == TokenKind::close) {
        document_.well_nested = false;
        errors_.add(token.where(), "this ) has no matching (");
        ++at_;
      } else if (token.kind == TokenKind::word && token.text == "define") {
        define(true);
      } else if (StageEntity entity; item(document_.world, entity, 1)) {
        document_.items.push_back({.entity = entity});
      }
    }
  }

 private:
  StageToken peek(std::size_t ahead = 0) const {
    return document_.token(static_cast<std::uint32_t>(std::min(at_ + ahead, document_.tokens.size() - 1)));
  }
  std::uint32_t position() const { return static_cast<std::uint32_t>(at_); }
  static bool same_line(const StageToken& a, const StageToken& b) {
    return a.file == b.file && a.line == b.line;
  }

  /// Moves the elements of `open` with index `since` and above to the end of `all`. Returns the range of
  /// `all` that they occupy.
  template <class T>
  static StageEntity::Run close(std::vector<T>& open, std::size_t since, std::vector<T>& all) {
    const StageEntity::Run run{static_cast<std::uint32_t>(all.size()),
                               static_cast<std::uint32_t>(open.size() - since)};
    const auto begin = open.begin() + static_cast<std::ptrdiff_t>(since);
    all.insert(all.end(), begin, open.end());
    open.erase(begin, open.end());
    return run;
  }

  /// Parses the body of `entity` up to its closing ). The opening ( is already consumed.
  void body(StageEntity& entity, std::size_t depth) {
    const std::size_t properties = open_properties_.size();
    const std::size_t children = open_children_.size();
    if (depth > k_deepest_nesting) {
      document_.well_nested = false;
      errors_.add(document_.token(entity.word).where(),
                  fmt::format("models and blocks are nested too deep: at most {} levels are allowed",
                              k_deepest_nesting));
      throw GiveUp{};
    }
    while (peek().kind != TokenKind::close) {
      if (peek().kind == TokenKind::end) {
        document_.well_nested = false;
        errors_.add(document_.token(entity.word).where(),
                    fmt::format("the ( of \"{}\" is never closed: add a )", document_.word(entity)));
        return;
      }
      if (peek().kind == TokenKind::word && peek().text == "define") {
        errors_.add(peek().where(), "define is only allowed at the top level of a file, not inside a model");
        define(false);
        continue;
      }
      if (StageEntity child; item(open_properties_, child, depth + 1)) open_children_.push_back(child);
    }
    ++at_;
    entity.properties = close(open_properties_, properties, document_.all_properties);
    entity.children = close(open_children_, children, document_.all_children);
  }

  /// Parses one property, which it adds to `properties`, or one entity, which it stores in `entity`. Returns
  /// true for an entity.
  bool item(std::vector<StageProperty>& properties, StageEntity& entity, std::size_t depth) {
    const StageToken token = peek();
    if (token.kind != TokenKind::word) {
      skip_misplaced(depth);
      return false;
    }
    const StageToken next = peek(1);
    if (next.kind == TokenKind::open) {
      entity.word = position();
      at_ += 2;
      body(entity, depth);
      return true;
    }
    const bool has_value = next.kind != TokenKind::end && same_line(token, next);
    if (has_value && (next.kind == TokenKind::number || next.kind == TokenKind::string)) {
      properties.push_back({position(), 1, false});
      at_ += 2;
    } else if (has_value && next.kind == TokenKind::tuple_open) {
      const std::uint32_t key = position();
      ++at_;
      properties.push_back({key, tuple(), true});
    } else if (has_value && next.kind == TokenKind::word && peek(2).kind != TokenKind::open) {
      errors_.add(
          token.where(),
          fmt::format("the value of \"{0}\" must be a number, a string or a tuple; a string needs quotes: "
                      "{0} \"{1}\"",
                      token.text, next.text));
      at_ += 2;
    } else {
      errors_.add(
          token.where(),
          fmt::format("\"{}\" needs a value on the same line, or a list of properties in ( )", token.text));
      ++at_;
    }
    return false;
  }

  /// Reports an error for the next token, which begins neither a property nor an entity, and skips it. Also
  /// skips what belongs to it: the rest of a tuple, or the content of parentheses.
  void skip_misplaced(std::size_t depth) {
    const StageToken token = peek();
    switch (token.kind) {
      case TokenKind::open: {
        errors_.add(token.where(),
                    "a ( is allowed only directly after a word, such as a model type or the name of a macro");
        StageEntity dropped{.word = position()};
        ++at_;
        body(dropped, depth);
        return;
      }
      case TokenKind::tuple_open:
        errors_.add(token.where(),
                    "this tuple has no property name before it; a property is written: name [1 2 3]");
        static_cast<void>(tuple());
        return;
      case TokenKind::tuple_close: errors_.add(token.where(), "this ] has no matching ["); break;
      default:
        errors_.add(
            token.where(),
            fmt::format("the value {} has no property name before it; a property is written: name value",
                        shown(token)));
    }
    ++at_;
  }

  /// Parses a tuple, from [ to ] on one line. A tuple over several lines is one error, and its values are
  /// read. Returns the number of values before the first other error.
  std::uint32_t tuple() {
    const StageToken open = peek();
    ++at_;
    std::uint32_t count = 0;
    bool clean = true;
    bool is_on_line = true;
    std::size_t inner = 0;  // number of tuples in this tuple that are not closed yet
    for (;; ++at_) {
      const StageToken token = peek();
      const bool is_value = token.kind == TokenKind::number || token.kind == TokenKind::string;
      const bool is_end = token.kind == TokenKind::tuple_close;
      const bool is_outside =
          token.kind == TokenKind::end || token.kind == TokenKind::open || token.kind == TokenKind::close;
      if (is_on_line && (is_outside || !same_line(open, token))) {
        errors_.add(open.where(), "a tuple must end with ] on the line on which it begins");
        is_on_line = false;
      }
      if (!is_on_line && !is_value && !is_end) return count;
      if (is_end && inner == 0) break;
      if (is_end) {
        --inner;
        continue;
      }
      if (is_value) {
        count += clean;
        continue;
      }
      inner += token.kind == TokenKind::tuple_open;
      clean = false;
      errors_.add(
          token.where(),
          token.kind == TokenKind::word
              ? fmt::format("\"{0}\" in a tuple is not a number; a text needs quotes: [\"{0}\"]", token.text)
              : std::string("a tuple cannot contain a tuple: remove the inner [ and ]"));
    }
    ++at_;
    return count;
  }

  /// Parses `define NAME BASE body`. If `keep` is false, drops the macro, because a macro inside a model is
  /// an error.
  void define(bool keep) {
    const StageToken word = peek();
    ++at_;
    if (peek().kind != TokenKind::word) {
      errors_.add(word.where(),
                  "define needs a name and a base, which is a model type or a macro: define "
                  "robot position( ... )");
      return;
    }
    StageItem item{.is_define = true, .entity = {.word = position()}};
    const std::string_view name = peek().text;
    ++at_;
    bool usable = true;
    if (name.size() > engine::k_most_name_bytes) {
      errors_.add(word.where(), fmt::format("the name has {} bytes, but a name has at most {}", name.size(),
                                            engine::k_most_name_bytes));
      usable = false;
    }
    if (peek().kind == TokenKind::word) {
      item.base = position();
      ++at_;
    } else {
      errors_.add(word.where(), fmt::format("define {0} needs a base, which is a model type or a macro: "
                                            "define {0} position( ... )",
                                            name));
      usable = false;
    }
    if (peek().kind != TokenKind::open) {
      if (usable) errors_.add(word.where(), fmt::format("define {} needs a list of properties in ( )", name));
      return;
    }
    ++at_;
    body(item.entity, 1);
    if (usable && keep) document_.items.push_back(item);
  }

  static std::string shown(const StageToken& token) {
    return token.kind == TokenKind::string ? fmt::format("\"{}\"", token.text) : std::string(token.text);
  }

  StageDocument& document_;
  SyntaxErrors& errors_;
  std::vector<StageProperty> open_properties_;  // properties of the entities whose ) is not reached yet
  std::vector<StageEntity> open_children_;
  std::size_t at_ = 0;
};

}  // namespace

std::optional<std::int64_t> index_in(std::string_view key, std::string_view stem) {
  if (!key.starts_with(stem) || key.substr(stem.size(), 1) != "[" || !key.ends_with(']')) return {};
  key.remove_prefix(stem.size() + 1);
  key.remove_suffix(1);
  return number_of<std::int64_t>(key);
}

StageDocument parse_stage(const fs::path& file, std::string text, std::span<const fs::path> search_path,
                          Diagnostics& diagnostics) {
  StageDocument document;
  document.base_directory = file.parent_path();
  SyntaxErrors errors(diagnostics);
  try {
    Lexer(document, search_path, diagnostics, errors).read(file, std::move(text));
    document.tokens.push_back({.kind = TokenKind::end});
    Parser(document, errors).read();
  } catch (const GiveUp&) {
    document.well_nested = false;
  }
  return document;
}

}  // namespace troupe::worldio
